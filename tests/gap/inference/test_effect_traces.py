import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.effect_traces import NotJudged, lacking, trace
from hyperleg_design.gap.inference.linearisation import reach


@pytest.fixture(scope="module")
def evidence(robot_files):
    return diagnosed.evidence(
        robot_files["coupled"],
        diagnosed.run("viscous", 0),
        references=(diagnosed.run("viscous", 1, role="reference"),),
    )


def test_what_logs_lack_is_said(evidence):
    told = trace(evidence.samples, EFFECTS["command_delay"], "robot")
    assert isinstance(told, NotJudged)
    assert "lack" in told.reason
    assert not lacking(EFFECTS["coulomb_friction"], "knee", evidence.signals)


def test_a_linear_effect_is_traced_by_its_columns_and_another_by_its_starts(evidence):
    (friction,) = trace(evidence.samples, EFFECTS["viscous_friction"], "knee")
    assert isinstance(friction, Cause)
    assert reach(evidence.samples, friction.columns) > 0
    starts = trace(evidence.samples, EFFECTS["backlash"], "m_back")
    assert len(starts.values) == len(starts.traces)
    assert starts.columns.shape[1] == len(evidence.samples.value)


def test_starts_of_an_effect_with_a_span_have_the_traces_of_their_values(evidence):
    effect = EFFECTS["payload"]
    link = effect.locations(evidence.signals[0].subject)[-1]
    starts = trace(evidence.samples, effect, link)
    assert starts.columns.shape == (10, len(evidence.samples.value))
    exact = evidence.samples.columns(
        lambda s: effect.trace(s, link, starts.values), len(starts.values), effect.inertial
    )
    np.testing.assert_allclose(starts.traces, exact, atol=1e-9 * np.abs(exact).max())
