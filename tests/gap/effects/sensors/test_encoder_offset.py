import numpy as np
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

OFFSET = effect("encoder_offset")


def test_trace_is_what_a_wrong_zero_leaves(pendulum):
    signals = pendulum(Wrong(offset=0.08))
    assert misfit(signals, OFFSET.trace(signals, "swing", np.array([[0.08]]))) < 0.02


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("encoder_offset", [0.05])
    assert misfit(signals, OFFSET.trace(signals, "swing", np.array([[0.05]]))) < 0.02


def test_trace_is_exact_at_any_offset(leg):
    from hyperleg_design.gap.model import rigid

    signals = leg(duration=2.0)
    subject, offsets = signals.subject, np.array([-0.3, 0.01, 0.25])
    for joint, name in enumerate(subject.joints):
        found = OFFSET.trace(signals, name, offsets[:, None])["motion"]
        for row, offset in enumerate(offsets):
            position = signals.position.copy()
            position[:, joint] -= offset
            motion = signals.velocity, signals.acceleration
            expected = rigid.inverse_dynamics(subject, position, *motion) - rigid.inverse_dynamics(
                subject, signals.position, *motion
            )
            np.testing.assert_allclose(found[row], expected, atol=1e-10)
