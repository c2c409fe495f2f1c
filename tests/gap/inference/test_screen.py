import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.screen import (
    NotJudged,
    lacking,
    linearise,
    reach,
    trace,
    under_test,
)


@pytest.fixture(scope="module")
def found(robot_files):
    return diagnosed.evidence(
        robot_files["coupled"],
        diagnosed.run("viscous", 0),
        references=(diagnosed.run("viscous", 1, role="reference"),),
    )


def test_what_logs_lack_is_said(found):
    told = trace(found.samples, EFFECTS["command_delay"], "robot")
    assert isinstance(told, NotJudged)
    assert "lack" in told.reason
    assert not lacking(EFFECTS["coulomb_friction"], "knee", found.signals)


def test_a_linearised_trace_is_the_trace(found):
    effect = EFFECTS["encoder_offset"]
    cause = linearise(found.samples, effect, "knee", np.array([0.05]))
    exact = found.samples.columns(lambda s: effect.trace(s, "knee", np.array([[0.06]])), 1)[0]
    near = cause.constant + (0.06 - cause.nulls[0]) / cause.usual[0] * cause.columns[0]
    assert np.abs(near - exact).max() < 0.02 * np.abs(exact).max()


def test_a_linear_effect_is_traced_by_its_columns_and_another_by_its_starts(found):
    (friction,) = trace(found.samples, EFFECTS["viscous_friction"], "knee")
    assert isinstance(friction, Cause)
    assert reach(found.samples, friction.columns) > 0
    starts = trace(found.samples, EFFECTS["backlash"], "m_back")
    assert len(starts.values) == len(starts.traces)
    assert starts.columns.shape[1] == len(found.samples.value)


def test_starts_of_an_effect_with_a_span_have_the_traces_of_their_values(found):
    effect = EFFECTS["payload"]
    link = effect.locations(found.signals[0].subject)[-1]
    starts = trace(found.samples, effect, link)
    assert starts.columns.shape == (10, len(found.samples.value))
    exact = found.samples.columns(
        lambda s: effect.trace(s, link, starts.values), len(starts.values), effect.inertial
    )
    np.testing.assert_allclose(starts.traces, exact, atol=1e-9 * np.abs(exact).max())


def test_torques_over_accelerations_count_as_far_as_drives_feel_them(found):
    samples, effect = found.samples, EFFECTS["rotor_inertia"]
    values = np.array([[0.01]])
    whole = samples.columns(lambda s: effect.trace(s, "m_back", values), 1)
    counted = samples.columns(lambda s: effect.trace(s, "m_back", values), 1, effect.inertial)
    np.testing.assert_array_equal(counted, whole * samples.felt)


def test_samples_under_test_come_first_and_have_the_same_trace(found):
    effect = EFFECTS["viscous_friction"]
    (whole,), (own,) = (trace(one, effect, "knee") for one in (found.samples, found.tests))
    np.testing.assert_array_equal(under_test(whole, found.tests).columns, own.columns)
