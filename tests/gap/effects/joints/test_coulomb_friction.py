import numpy as np
import pytest
from pendulum import Wrong, misfit, steps

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.joints.coulomb_friction import SPEEDS

COULOMB = effect("coulomb_friction")


def test_trace_is_what_a_pendulum_with_bristles_leaves(pendulum):
    for options in ({}, {"target": steps}, {"sees": ()}):
        signals = pendulum(Wrong(coulomb=0.5), **options)
        assert misfit(signals, COULOMB.trace(signals, "swing", np.array([[0.5, 0.0]]))) < 0.15


def test_least_squares_find_the_torque_despite_holds(pendulum):
    signals = pendulum(Wrong(coulomb=0.5), target=steps)
    rows, found = (
        COULOMB.trace(signals, "swing", np.array([[1.0, 0.0]]))["motion"][0],
        signals.residual["motion"],
    )
    use = signals.valid
    assert abs((rows[use] * found[use]).sum() / (rows[use] ** 2).sum() - 0.5) < 0.05


def test_simulation_with_it_leaves_its_trace(simulated):
    for reversal in range(len(SPEEDS)):
        values = [0.4, reversal]
        signals = simulated("coulomb_friction", values)
        assert misfit(signals, COULOMB.trace(signals, "swing", np.array([values]))) < 0.35


@pytest.mark.parametrize("reversal", range(1, len(SPEEDS)))
def test_a_way_to_reverse_is_tanh_of_the_speed(pendulum, reversal):
    signals = pendulum(Wrong())
    trace = COULOMB.trace(signals, "swing", np.array([[0.5, reversal], [0.5, 0.0]]))["motion"]
    width = SPEEDS[int(reversal)]
    assert np.allclose(
        trace[0, :, 0], 0.5 * np.tanh(signals.velocity[:, 0] / width), equal_nan=True
    )
    assert not np.allclose(trace[0], trace[1], equal_nan=True)


def test_no_joint_has_less_friction_than_none():
    from hyperleg_design.gap.signals.loading import load_subject

    subject = load_subject("hyperleg")
    low, _ = COULOMB.bounds("left_knee", subject)
    assert low[0] == -subject.coulomb[subject.joints.index("left_knee")]
    assert COULOMB.alteration("left_knee", np.array([-50.0, 0.0]), subject).coulomb == low[0]


def test_where_no_torque_is_logged_friction_reverses_at_once(pendulum):
    for sees, ways in (
        (("motor_torque",), len(SPEEDS)),
        (("motor_torque_command",), len(SPEEDS)),
        ((), 1),
    ):
        variants = COULOMB.variants(pendulum(Wrong(), sees=sees), "swing")
        assert variants.tolist() == [[0.0, float(way)] for way in range(ways)]


def test_friction_that_reverses_over_a_speed_is_less_likely(pendulum):
    subject = pendulum(Wrong()).subject
    at_once, gradual = (COULOMB.odds("swing", subject, np.array([0.5, r])) for r in (0.0, 2.0))
    assert gradual < at_once == 0
