import numpy as np
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

SPRING = effect("joint_spring")


def test_trace_is_what_a_spring_leaves(pendulum):
    signals = pendulum(Wrong(stiffness=1.0, preload=0.3))
    assert misfit(signals, SPRING.trace(signals, "swing", np.array([[1.0, 0.3]]))) < 0.01


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("joint_spring", [1.0, 0.3])
    assert misfit(signals, SPRING.trace(signals, "swing", np.array([[1.0, 0.3]]))) < 0.02


def test_preload_is_the_torque_at_the_posture_of_rest():
    from types import SimpleNamespace

    from hyperleg_design.gap.signals.loading import load_subject

    subject = load_subject("hyperleg")
    knee = subject.joints.index("left_knee")
    signals = SimpleNamespace(subject=subject, position=np.tile(subject.default, (3, 1)))
    found = SPRING.trace(signals, "left_knee", np.array([[20.0, 1.5]]))["motion"][0]
    assert np.all(found[:, knee] == 1.5)
    assert np.all(np.delete(found, knee, 1) == 0)


def test_people_read_the_angle_of_rest(pendulum):
    subject = pendulum(Wrong()).subject
    rest = SPRING.derived("swing", np.array([2.0, 0.5]), subject)["rest"][0]
    signals = pendulum(Wrong())
    where = signals.position[:, 0]
    trace = SPRING.trace(signals, "swing", np.array([[2.0, 0.5]]))["motion"][0, :, 0]
    np.testing.assert_allclose(trace, 2.0 * (where - rest))
    assert SPRING.derived("swing", np.array([0.01, 0.5]), subject) == {}
    assert SPRING.derived("swing", np.array([0.0, 0.0]), subject) == {}


def test_the_zero_of_a_torque_sensor_may_wander_more_than_springs_are_usual():
    from hyperleg_design.gap.effects.strength import joint_strength
    from hyperleg_design.gap.signals.loading import load_subject

    subject = load_subject("hyperleg")
    stiffness, preload = SPRING.session_spreads(subject, 0.005)["left_knee"]
    knee = subject.joints.index("left_knee")
    assert preload == 0.01 * joint_strength(subject)[knee]
    assert stiffness < preload
