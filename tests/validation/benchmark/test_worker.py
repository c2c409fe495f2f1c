"""The worker of the benchmark: it finds the diagnosis of a checkout, and a crash is an answer."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest

from hyperleg_design.validation.benchmark import worker
from hyperleg_design.validation.benchmark.case import Material, Recording, write_case


def test_the_first_module_that_has_the_name_counts():
    import collections.abc
    import json.decoder

    assert worker.first(("no_such_module", "json.decoder"), "JSONDecoder") is json.JSONDecoder
    assert worker.first(("json.decoder", "collections.abc"), "Mapping") is collections.abc.Mapping
    assert worker.first(("no_such_module", "json.none"), "x") is None


def test_a_module_that_lacks_another_one_is_not_passed_over(tmp_path, monkeypatch):
    (tmp_path / "half_there.py").write_text("import no_such_module_either\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ModuleNotFoundError, match="no_such_module_either"):
        worker.first(("half_there", "json"), "loads")


@pytest.fixture
def case(tmp_path):
    log = Recording("a", np.linspace(0, 1, 11), {"position/hip": np.zeros(11)}, {"base": "fixed"})
    return write_case(Material("<mujoco/>", (log,), (log, log)), tmp_path / "case")


def run(case, monkeypatch, diagnose):
    monkeypatch.setattr(
        worker, "first", lambda modules, name: diagnose if name == "diagnose" else str
    )
    answer = case / "answer.json"
    monkeypatch.setattr(sys, "argv", ["worker.py", str(case), str(answer)])
    worker.main()
    return json.loads(answer.read_text())


def test_the_diagnosis_gets_robot_logs_and_references(case, monkeypatch):
    def diagnose(robot, logs, references, **settings):
        return {"robot": robot, "counts": [len(logs), len(references)], **settings}

    answer = run(case, monkeypatch, diagnose)
    expected = {"robot": str(case / "robot.xml"), "counts": [1, 2], "seed": 0, "threads": 1}
    assert answer["diagnosis"] == expected
    assert answer["seconds"] >= 0


def test_a_diagnosis_that_breaks_is_the_answer_error(case, monkeypatch):
    def diagnose(*arguments, **settings):
        raise ZeroDivisionError("by nothing")

    diagnosis = run(case, monkeypatch, diagnose)["diagnosis"]
    assert diagnosis["verdict"] == "error"
    assert diagnosis["message"] == "ZeroDivisionError: by nothing"


@pytest.mark.parametrize(
    ("code", "verdict"), [(0, "none"), (2, "error")], ids=["it answers", "it fails"]
)
def test_without_a_module_the_command_line_is_asked(case, monkeypatch, code, verdict):
    seen = []

    def asked(command, **settings):
        seen.append(command)
        out = case / "by_command"
        out.mkdir()
        (out / "diagnosis.json").write_text('{"verdict": "none"}')
        error = b"a warning\nhyperleg: bad\n"
        return type("Run", (), {"returncode": code, "stderr": error})

    monkeypatch.setattr(worker.subprocess, "run", asked)
    diagnosis = run(case, monkeypatch, None)["diagnosis"]
    assert diagnosis["verdict"] == verdict
    assert code == 0 or diagnosis["message"] == "hyperleg: bad"
    words = seen[0]
    references = words[words.index("--reference") + 1 : words.index("--threads")]
    assert [name.split("/")[-2] for name in references] == ["references"] * 2
