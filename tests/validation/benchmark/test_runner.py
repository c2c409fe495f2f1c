"""A run goes on where it was stopped, and tells what it could not use."""

from __future__ import annotations

import json
from functools import partial

import numpy as np
import pytest

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.validation.benchmark import runner
from hyperleg_design.validation.benchmark.case import (
    SPLITS,
    Case,
    Fault,
    Material,
    Recording,
    Truth,
    write_case,
)

FAULT = Fault("torque_constant", ("elbow",), {"scale": 0.75})


def build(data, faults=()):
    time = np.arange(20) * 0.01
    log = Recording("log", time, {"position/elbow": np.sin(time)}, {"base": "fixed"})
    return Material("<mujoco/>", (log,), (log,)), Truth(faults, references=True)


def fail(data):
    raise InputError("recording", "t", None, "is damaged")


CASES = [
    Case("first", "real", "development", "one", "single", partial(build, faults=(FAULT,))),
    Case("second", "real", "held out", "two", "nothing", build),
    Case("absent", "real", "held out", "three", "nothing", build, needs="a_robot"),
]


@pytest.fixture
def diagnosed(monkeypatch):
    """Diagnoses without a process: what the runner handed over, and a made-up answer."""
    seen = []

    def diagnose(case, checkout=None):
        entry = json.loads((case / "case.json").read_text())
        seen.append(entry)
        for name in [*entry["logs"], *entry["references"]]:
            assert (case / name).is_file()
        assert "torque_constant" not in (case / "case.json").read_text()
        return {"verdict": "none", "causes": [], "sensitivity": [1]}, 0.5

    monkeypatch.setattr(runner, "diagnose_folder", diagnose)
    monkeypatch.setattr(runner, "all_cases", lambda: CASES)
    return seen


def test_cases_are_run_once_scored_and_those_without_logs_are_skipped_with_a_reason(
    diagnosed, tmp_path
):
    out = tmp_path / "out"
    first = runner.run_benchmark(out, CASES, tmp_path)
    assert [row["score"]["outcome"] for row in first.rows] == ["none", "right"]
    assert len(first.skipped) == 1
    assert "a_robot" in first.skipped[0]
    assert "HYPERLEG_DATA" in first.skipped[0]
    assert "a_robot is absent" in first.markdown()
    assert len(diagnosed) == 2
    again = runner.run_benchmark(out, CASES, tmp_path)
    assert len(diagnosed) == 2
    assert again.rows == first.rows
    stored = json.loads((out / "results.json").read_text())
    assert [row["name"] for row in stored["cases"]] == ["first", "second"]
    assert "sensitivity" not in stored["cases"][0]["diagnosis"]


def test_a_stopped_run_goes_on(diagnosed, tmp_path, monkeypatch):
    out = tmp_path / "out"
    runner.run_benchmark(out, CASES[:1], tmp_path)
    assert len(diagnosed) == 1
    rows = runner.run_benchmark(out, CASES, tmp_path).rows
    assert len(diagnosed) == 2
    assert [row["name"] for row in rows] == ["first", "second"]


@pytest.mark.parametrize(
    "content",
    ["", "{", "[]", "{}", '{"version": 0}', '{"version": 1, "name": "first"}'],
)
def test_a_damaged_or_old_result_is_told_and_made_anew(diagnosed, tmp_path, content):
    out = tmp_path / "out"
    whole = runner.run_benchmark(out, CASES[:1], tmp_path)
    (out / "cases" / "first.json").write_text(content)
    mended = runner.run_benchmark(out, CASES[:1], tmp_path)
    assert len(mended.remarks) == 1
    assert "first.json" in mended.remarks[0]
    assert mended.rows == whole.rows
    assert len(diagnosed) == 2


def test_a_case_that_cannot_be_made_is_an_error_of_that_case_alone(diagnosed, tmp_path):
    broken = Case("first", "real", "development", "broken", "nothing", fail)
    runner.store(broken, tmp_path, tmp_path)
    entry = json.loads((tmp_path / "cases" / "first.json").read_text())
    assert entry["diagnosis"]["verdict"] == "error"
    assert "is damaged" in entry["diagnosis"]["message"]


def test_nothing_is_written_over_somebody_elses_folder(diagnosed, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "theirs.txt").write_text("x")
    with pytest.raises(OutputError, match="did not write"):
        runner.run_benchmark(tmp_path / "out", CASES, tmp_path)
    with pytest.raises(InputError, match="workers"):
        runner.run_benchmark(tmp_path / "new", CASES, tmp_path, workers=0)


def test_choices_that_fit_nothing_are_refused(diagnosed):
    assert [c.name for c in runner.chosen_cases(["real"], SPLITS, ["sec"])] == ["second"]
    with pytest.raises(InputError, match="only"):
        runner.chosen_cases(only=["nowhere"])
    with pytest.raises(InputError, match="suites"):
        runner.chosen_cases(suites=["unreal"])
    with pytest.raises(InputError, match="splits"):
        runner.chosen_cases(splits=[])


def test_a_case_has_a_file_name_and_known_suite_split_and_kind():
    for bad in ({"name": "../x"}, {"suite": "toy"}, {"split": "test"}, {"kind": "odd"}):
        fields = {"name": "x", "suite": "real", "split": SPLITS[0], "kind": "nothing", **bad}
        with pytest.raises(InputError):
            Case(about="", build=build, **fields)
    with pytest.raises(InputError, match="places"):
        Fault("payload", ())


def test_files_of_a_case_are_logs_as_the_format_says(tmp_path):
    from hyperleg_design.validation.benchmark.adapter import open_recordings

    material, _ = build(None)
    write_case(material, tmp_path / "case")
    entry = json.loads((tmp_path / "case" / "case.json").read_text())
    assert (tmp_path / "case" / entry["robot"]).read_text() == "<mujoco/>"
    (test,) = open_recordings(tmp_path / "case" / entry["logs"][0])
    (reference,) = open_recordings(tmp_path / "case" / entry["references"][0])
    np.testing.assert_array_equal(
        test.signals["position/elbow"], material.logs[0].signals["position/elbow"]
    )
    assert test.metadata["base"] == "fixed"
    assert reference.metadata["role"] == "reference"


def test_all_cases_of_this_version_have_names_of_their_own_and_a_third_of_the_real_ones_is_healthy(
    monkeypatch,
):
    monkeypatch.undo()
    cases = runner.all_cases()
    assert len({case.name for case in cases}) == len(cases)
    real = [case for case in cases if case.suite == "real"]
    assert len(real) >= 60
    assert sum(case.kind == "nothing" for case in real) >= len(real) / 3
    for suite in ("real", "newcomers", "blind"):
        assert {case.split for case in cases if case.suite == suite} == set(SPLITS)
