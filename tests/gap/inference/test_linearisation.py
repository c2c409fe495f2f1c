import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.effect_traces import trace
from hyperleg_design.gap.inference.linearisation import linearise, under_test


def test_a_linearised_trace_is_the_trace(viscous):
    effect = EFFECTS["encoder_offset"]
    cause = linearise(viscous.samples, effect, "knee", np.array([0.05]))
    exact = viscous.samples.columns(lambda s: effect.trace(s, "knee", np.array([[0.06]])), 1)[0]
    near = cause.constant + (0.06 - cause.nulls[0]) / cause.usual[0] * cause.columns[0]
    assert np.abs(near - exact).max() < 0.02 * np.abs(exact).max()


def test_torques_over_accelerations_count_as_far_as_drives_feel_them(viscous):
    samples, effect = viscous.samples, EFFECTS["rotor_inertia"]
    values = np.array([[0.01]])
    whole = samples.columns(lambda s: effect.trace(s, "m_back", values), 1)
    counted = samples.columns(lambda s: effect.trace(s, "m_back", values), 1, effect.inertial)
    np.testing.assert_array_equal(counted, whole * samples.felt)


def test_samples_under_test_come_first_and_have_the_same_trace(viscous):
    effect = EFFECTS["viscous_friction"]
    (whole,), (own,) = (trace(one, effect, "knee") for one in (viscous.samples, viscous.tests))
    np.testing.assert_array_equal(under_test(whole, viscous.tests).columns, own.columns)


def test_a_ratio_that_no_speed_of_a_motor_shows_is_unseen(viscous):
    effect, values = EFFECTS["transmission_ratio"], np.array([1.05, 0.0])
    shown = any("transmission" in log.residual for log in viscous.signals)
    cause = linearise(viscous.samples, effect, "m_back", values)
    assert cause.unseen is not shown
    assert (
        linearise(viscous.samples, EFFECTS["rotor_inertia"], "m_back", values[:1]).unseen is False
    )
