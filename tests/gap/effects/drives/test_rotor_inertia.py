import numpy as np
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
