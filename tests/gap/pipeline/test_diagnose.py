import json

import diagnosed
import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.pipeline.diagnose import diagnose, diagnose_signals


def test_a_healthy_robot_has_no_gap(robot_files):
    result = diagnosed.diagnosis(robot_files, "healthy")
    assert result.verdict == "none"
    assert not result.causes
    assert not result.equivalent


def test_a_cause_is_named_with_place_and_size(viscous):
    assert viscous.verdict in ("explained", "ambiguous")
    cause = viscous.causes[0]
    assert (cause.effect, cause.location) == ("viscous_friction", "knee")
    damping = cause.parameters["damping"]
    assert damping.low < 0.3 < damping.high
    assert damping.value == pytest.approx(0.3, rel=0.15)
    assert viscous.gap.closed > 0.9
    assert viscous.gap.before > 2 * viscous.gap.after
    assert (viscous.gap.unit, 0.05 < viscous.gap.before < 3) == ("Nm", True)  # 0.3 Nms/rad lacks
    assert viscous.where[0].location == "knee"
    assert 0 < cause.probability <= 1


@pytest.mark.slow
def test_reference_logs_make_it_surer(robot_files):
    result = diagnosed.diagnosis(robot_files, "dry", references=(2, 3))
    assert (result.causes[0].effect, result.causes[0].location) == ("coulomb_friction", "hip")
    assert result.causes[0].parameters["torque"].value == pytest.approx(0.8, rel=0.2)
    assert not any("no reference" in check for check in result.checks)


def test_two_causes_are_both_named(robot_files):
    result = diagnosed.diagnosis(robot_files, "both")
    assert {(c.effect, c.location) for c in result.causes} == {
        ("viscous_friction", "knee"),
        ("coulomb_friction", "hip"),
    }


def test_the_same_logs_and_seed_give_the_same_bits_at_any_thread_count(robot_files, viscous):
    logs = [diagnosed.run("viscous", s, session="today") for s in (0, 1)]
    again = diagnose(robot_files["coupled"], logs, threads=2)
    assert json.dumps(again.mapping()) == json.dumps(viscous.mapping())


def test_effects_without_their_signals_are_not_judged(viscous):
    reasons = {n["effect"]: n["reason"] for n in viscous.not_judged}
    for effect in ("command_delay", "controller_gain", "torque_saturation"):
        assert effect not in {c.effect for c in (*viscous.causes, *viscous.rivals)}
    assert "signals" in reasons["command_delay"] or "excite" in reasons["command_delay"]


def test_logs_that_are_all_references_are_refused(robot_files):
    with pytest.raises(InputError, match="reference"):
        diagnose(robot_files["coupled"], [diagnosed.run("healthy", 0, role="reference")])
    with pytest.raises(InputError, match="logs"):
        diagnose(robot_files["coupled"], [])
    with pytest.raises(InputError, match="missing"):
        diagnose_signals([])


def test_a_log_in_degrees_is_refused(robot_files):
    log = diagnosed.run("healthy", 0)
    wrong = log.changed(
        signals={
            c: np.degrees(v) if c.startswith("velocity/") else v for c, v in log.signals.items()
        }
    )
    with pytest.raises(InputError, match="rad"):
        diagnose(robot_files["coupled"], [wrong])
