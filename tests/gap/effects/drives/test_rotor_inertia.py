import numpy as np
import pytest
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

ROTOR = effect("rotor_inertia")


def test_trace_is_what_a_heavy_rotor_leaves(pendulum):
    signals = pendulum(Wrong(rotor=0.02))
    assert misfit(signals, ROTOR.trace(signals, "swing", np.array([[0.02]]))) < 0.02


def test_simulation_with_it_leaves_its_trace_at_all_joints_of_the_motor(leg):
    one = effect("rotor_inertia")
    subject = leg(duration=1.0).subject
    signals = leg(one.alteration("m_back", np.array([0.01]), subject))
    trace = one.trace(signals, "m_back", np.array([[0.01]]))["motion"][0]
    use = signals.valid
    assert (
        np.sqrt(np.mean((signals.residual["motion"] - trace)[use] ** 2) / np.mean(trace[use] ** 2))
        < 0.02
    )


def test_no_rotor_is_lighter_than_none(pendulum):
    subject = pendulum(Wrong()).subject
    assert ROTOR.bounds("swing", subject)[0, 0] == -subject.rotor_inertia[0]
    assert ROTOR.alteration("swing", np.array([-1.0]), subject).inertia == -subject.rotor_inertia[0]


def test_a_rotor_that_a_file_leaves_out_is_sized_by_its_drive(tmp_path, robot_files):
    """Of a wrist of 2e-5 kg m^2 on a servo of 3 Nm, whose rotor is hundreds of times as much."""
    from hyperleg_design.gap.signals.loading import load_subject

    path = tmp_path / "wrist.xml"
    path.write_text(
        """<mujoco><worldbody><body name="wrist"><joint name="roll" axis="1 0 0"/>
        <inertial pos="0 0 0" mass="0.1" diaginertia="2e-5 2e-5 2e-5"/></body></worldbody>
        <actuator><position name="roll" joint="roll" kp="8" forcerange="-3 3"/></actuator>
        </mujoco>"""
    )
    assert ROTOR.usual("roll", load_subject(path))[0] == pytest.approx(0.3 * 3 / 300)
    known = load_subject(robot_files["pendulum"])
    motor = known.motors[0]
    assert ROTOR.usual(motor, known)[0] == pytest.approx(0.3 * known.rotor_inertia[0])
