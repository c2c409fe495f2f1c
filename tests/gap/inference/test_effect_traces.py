import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.effect_traces import NotJudged, lacking, trace
from hyperleg_design.gap.inference.linearisation import reach


def test_what_logs_lack_is_said(viscous):
    told = trace(viscous.samples, EFFECTS["command_delay"], "robot")
    assert isinstance(told, NotJudged)
    assert "lack" in told.reason
    assert not lacking(EFFECTS["coulomb_friction"], "knee", viscous.signals)


def test_a_linear_effect_is_traced_by_its_columns_and_another_by_its_starts(viscous):
    (friction,) = trace(viscous.samples, EFFECTS["viscous_friction"], "knee")
    assert isinstance(friction, Cause)
    assert reach(viscous.samples, friction.columns) > 0
    starts = trace(viscous.samples, EFFECTS["backlash"], "m_back")
    assert len(starts.values) == len(starts.traces)
    assert starts.columns.shape[1] == len(viscous.samples.value)


def test_starts_of_an_effect_with_a_span_have_the_traces_of_their_values(viscous):
    effect = EFFECTS["payload"]
    link = effect.locations(viscous.signals[0].subject)[-1]
    starts = trace(viscous.samples, effect, link)
    assert starts.columns.shape == (10, len(viscous.samples.value))
    exact = viscous.samples.columns(
        lambda s: effect.trace(s, link, starts.values), len(starts.values), effect.inertial
    )
    np.testing.assert_allclose(starts.traces, exact, atol=1e-9 * np.abs(exact).max())
