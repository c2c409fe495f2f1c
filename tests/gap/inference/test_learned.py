import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.decide import decide, shown_already
from hyperleg_design.gap.inference.learned import ANOTHER_DAY, learned, unsaid
from hyperleg_design.gap.inference.screen import linearise, places
from hyperleg_design.gap.inference.thresholds import load_thresholds
from hyperleg_design.gap.signals.loading import load_subject

FRICTION = (("viscous_friction", "knee"), ("coulomb_friction", "knee"))


@pytest.fixture(scope="module")
def shown(viscous_ready):
    """What two logs with viscous friction at the knee would teach, were they reference logs."""
    return learned(shown_already(viscous_ready.base, load_thresholds(), FRICTION))


def test_what_reference_logs_name_is_learned(shown):
    (one,) = shown
    assert (one.effect, one.location) == FRICTION[0]
    assert one.values[0] == pytest.approx(0.3, abs=0.03)
    assert one.deviation[0] > ANOTHER_DAY * 0.25
    assert "viscous_friction at knee" in one.says


def test_its_trace_and_what_is_open_of_it_are_those_of_the_effect(shown, viscous_ready):
    (one,) = shown
    samples = viscous_ready.base.samples
    trace, more = one.columns(samples)
    cause = linearise(samples, EFFECTS[one.effect], one.location, one.values)
    assert np.allclose(trace, one.values[0] / cause.usual[0] * cause.columns[0])
    assert np.allclose(more, trace * one.deviation[0] / one.values[0])
    assert [error.spread for error in one.errors()] == pytest.approx(one.deviation.tolist())


def test_a_limit_that_the_healthy_robot_reaches_too_is_no_cause(robot_files):
    logs = [diagnosed.run("limited", s, session="a") for s in (0, 1)]
    healthy = [diagnosed.run("limited", s, session="b", role="reference") for s in (2, 3)]
    alone, beside = (
        diagnosed.prepared(robot_files["coupled"], *logs),
        diagnosed.prepared(robot_files["coupled"], *logs, references=healthy),
    )
    assert alone.learned == ()
    assert any("torque_saturation" in line for line in beside.learned)
    rules = load_thresholds()
    wanted = places(
        alone.base.samples.filtered_logs[0].signals.subject,
        ("torque_saturation", "torque_constant"),
    )
    assert decide(alone.base, rules, wanted)[1].model.names[0][0] == "torque_saturation"
    assert decide(beside.base, rules, wanted)[1].model.names == ()


def test_only_what_the_model_leaves_out_is_asked_of_reference_logs(robot_files):
    bare = load_subject(robot_files["pendulum"])
    assert bare.coulomb[0] == 0
    assert {place for _, place in unsaid(bare)} == {"swing"}
    assert {"coulomb_friction", "load_dependent_friction"} <= {name for name, _ in unsaid(bare)}
    assert unsaid(load_subject("hyperleg")) == []
