"""Diagnosis by the posterior of hypotheses, on a small robot in plain MuJoCo."""

import json
from types import SimpleNamespace

import diagnosed
import pytest

from hyperleg_design.gap.effects.joints.coulomb_friction import REVERSALS
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.pipeline.answer import Answer
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.results.diagnosis import SCHEMA_FILE, read_diagnosis
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.writing import write_json


def test_causes_that_close_the_main_part_come_first(monkeypatch):
    closed = {"ripple": (0.15,), "load": (0.2, 0.98), "belt": (0.99,), "dirt": (0.3,)}
    monkeypatch.setattr(
        Answer,
        "named",
        lambda _, __, name: [SimpleNamespace(name=name, closed=share) for share in closed[name]],
    )
    answer = Answer.__new__(Answer)
    answer.posterior = SimpleNamespace(hypothesis=SimpleNamespace(candidates=tuple(closed)))
    answer.rules = InferenceRules()
    ordered = [cause.name for cause in answer.causes((0, 1, 2, 3))]
    assert ordered == ["load", "load", "belt", "ripple", "dirt"]


def test_a_robot_like_its_references_is_none(robot_files):
    assert diagnosed.diagnosis(robot_files, "healthy", references=(2, 3)).verdict == "none"


def test_what_the_references_show_as_well_is_no_change_but_what_the_model_lacks(robot_files):
    logs = [diagnosed.run("dry", s, session="today") for s in (0, 1)]
    healthy = [diagnosed.run("dry", s, session="before", role="reference") for s in (2, 3)]
    result = diagnose(robot_files["coupled"], logs, healthy, threads=1)
    assert result.verdict == "none"
    assert not result.causes
    assert result.lacks["verdict"] == "explained"
    (cause,) = result.lacks["causes"]
    assert (cause["effect"], cause["location"]) == ("coulomb_friction", "hip")
    torque = cause["parameters"]["torque"]
    assert torque["low"] < 0.8 < torque["high"]


@pytest.mark.parametrize("references", [(), pytest.param((2, 3), marks=pytest.mark.slow)])
def test_a_torque_that_no_effect_has_is_unknown(robot_files, references):
    result = diagnosed.diagnosis(robot_files, "cubic_faint", references=references)
    assert result.verdict == "unknown"
    assert not result.causes
    assert result.remainder > 0.5
    assert result.residual_shape


def test_friction_that_reverses_over_a_speed_is_friction(robot_files):
    result = diagnosed.diagnosis(robot_files, "rounded")
    assert result.verdict == "explained"
    (cause,) = result.causes
    assert (cause.effect, cause.location) == ("coulomb_friction", "hip")
    shape = cause.parameters["reversal"].value
    assert REVERSALS[int(shape)] == "reverses over 0.3 rad/s"
    subject = load_subject(robot_files["coupled"])
    size = 2 * diagnosed.ROUNDED * subject.joint_from_motor[subject.joints.index("hip")].mean()
    torque = cause.parameters["torque"]
    assert torque.low < size < torque.high
    assert cause.closed > 0.9


@pytest.mark.slow
def test_friction_of_two_kinds_at_one_joint_is_named_and_no_torque_that_no_effect_has(robot_files):
    result = diagnosed.diagnosis(robot_files, "rubbing", references=(2, 3))
    assert result.verdict == "explained"
    sizes = {
        c.effect: next(iter(c.parameters.values())) for c in result.causes if c.location == "hip"
    }
    assert set(sizes) == {"coulomb_friction", "viscous_friction"}
    assert sizes["coulomb_friction"].low < 0.4 < sizes["coulomb_friction"].high
    assert sizes["viscous_friction"].low < 0.25 < sizes["viscous_friction"].high


def test_the_file_keeps_its_schema_and_reads_back(viscous, tmp_path):
    validate = pytest.importorskip("jsonschema").validate
    content = json.loads(json.dumps(viscous.mapping(), allow_nan=False))
    validate(content, json.loads(SCHEMA_FILE.read_text()))
    path = write_json(tmp_path / "diagnosis.json", viscous.mapping())
    assert read_diagnosis(path).mapping() == viscous.mapping()


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["healthy", "viscous"])
def test_a_reference_that_differs_from_the_others_is_told_and_gives_no_cause(robot_files, kind):
    logs = [diagnosed.run(kind, s, session="today") for s in (0, 1)]
    kinds = {2: "healthy", 3: "dry", 4: "healthy"}
    references = [
        diagnosed.run(one, s, session=f"before {s}", role="reference") for s, one in kinds.items()
    ]
    result = diagnose(robot_files["coupled"], logs, references, threads=1)
    expected = [("viscous_friction", "knee")] if kind == "viscous" else []
    assert [(one.effect, one.location) for one in result.causes] == expected
    odd = result.reference_differences[0]
    assert (odd["log"], odd["effect"], odd["location"]) == ("dry_3", "coulomb_friction", "hip")
    assert odd["parameters"]["torque"]["low"] < 0.8 < odd["parameters"]["torque"]["high"]
    assert result.mapping()["reference_differences"][0]["log"] == "dry_3"
