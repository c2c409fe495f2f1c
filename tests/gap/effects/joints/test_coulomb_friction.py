import numpy as np
from pendulum import Wrong, misfit, steps

from hyperleg_design.gap.effects import effect

COULOMB = effect("coulomb_friction")


def test_trace_is_what_a_pendulum_with_bristles_leaves(pendulum):
    for options in ({}, {"target": steps}, {"sees": ()}):
        signals = pendulum(Wrong(coulomb=0.5), **options)
        assert misfit(signals, COULOMB.trace(signals, "swing", np.array([[0.5]]))) < 0.15


def test_least_squares_find_the_torque_despite_holds(pendulum):
    signals = pendulum(Wrong(coulomb=0.5), target=steps)
    rows, found = (
        COULOMB.trace(signals, "swing", np.ones((1, 1)))["motion"][0],
        signals.residual["motion"],
    )
    use = signals.valid
    assert abs((rows[use] * found[use]).sum() / (rows[use] ** 2).sum() - 0.5) < 0.05


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("coulomb_friction", [0.4])
    assert misfit(signals, COULOMB.trace(signals, "swing", np.array([[0.4]]))) < 0.35


def test_no_joint_has_less_friction_than_none():
    from hyperleg_design.gap.signals.loading import load_subject

    subject = load_subject("hyperleg")
    low, _ = COULOMB.bounds("left_knee", subject)
    assert low[0] == -subject.coulomb[subject.joints.index("left_knee")]
    assert COULOMB.alteration("left_knee", np.array([-50.0]), subject).coulomb == low[0]
