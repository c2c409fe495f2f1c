import numpy as np
import pytest
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

RATIO = effect("transmission_ratio")


def test_trace_is_what_another_ratio_leaves(pendulum):
    signals = pendulum(Wrong(ratio=1.1))
    trace = RATIO.trace(signals, "swing", np.array([[1.1, 0.0]]))
    assert misfit(signals, trace) < 0.03
    # its rotor tells it from a torque constant
    assert misfit(
        signals, effect("torque_constant").trace(signals, "swing", np.array([[1.1, 0.0]]))
    ) > 5 * misfit(signals, trace)


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("transmission_ratio", [1.1, 0.0])
    assert misfit(signals, RATIO.trace(signals, "swing", np.array([[1.1, 0.0]]))) < 0.03


def test_simulations_have_ratios_of_their_own(leg):
    from hyperleg_design.gap.model.machine import machine_of

    subject = leg(duration=1.0).subject
    machine = RATIO.alteration("m_back", np.array([[1.0, 0.0], [0.9, 0.0]]), subject).machine(
        machine_of(subject)
    )
    np.testing.assert_allclose(machine.joint_from_motor[0], subject.joint_from_motor)
    np.testing.assert_allclose(machine.joint_from_motor[1], subject.joint_from_motor * [1.0, 0.9])
    np.testing.assert_allclose(machine.motor_from_joint, subject.motor_from_joint)


@pytest.mark.parametrize("motor", ["m_front", "m_back"])
def test_joints_told_from_rotors_stand_elsewhere(leg, motor):
    subject = leg(duration=1.0).subject
    right, wrong = np.array([[1.1, 1.0]]), np.array([[1.1, 0.0]])
    signals = leg(RATIO.alteration(motor, right[0], subject))
    whole = np.sqrt(np.mean(signals.residual["motion"][signals.valid] ** 2))

    def left(values):
        trace = RATIO.trace(signals, motor, values)["motion"][0]
        return np.sqrt(np.mean((signals.residual["motion"] - trace)[signals.valid] ** 2)) / whole

    assert left(right) < 0.01  # 0.07 if friction were that of the joints as logged
    assert left(wrong) > 3 * left(right)


def test_rotors_show_it_beside_their_joints(pendulum):
    signals = pendulum(Wrong(ratio=1.1), sees=("motor_torque", "motor_velocity"))
    assert (
        misfit(signals, RATIO.trace(signals, "swing", np.array([[1.1, 0.0]])), "transmission")
        < 0.03
    )
