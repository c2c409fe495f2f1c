"""Diagnoses in a process of their own, of any checkout."""

from __future__ import annotations

import json

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.validation.benchmark.adapter import diagnose_folder
from hyperleg_design.validation.benchmark.case import Material, Recording, write_case


@pytest.fixture
def case(tmp_path):
    time = np.arange(20) * 0.01
    log = Recording("log", time, {"position/elbow": np.sin(time)}, {"base": "fixed"})
    return write_case(Material("<mujoco/>", (log,)), tmp_path / "case")


def package(folder, diagnose):
    """A checkout with a diagnosis of its own, where old ones had it."""
    gap = folder / "hyperleg_design" / "gap"
    gap.mkdir(parents=True)
    for place in (gap.parent, gap):
        (place / "__init__.py").write_text("")
    (gap / "log.py").write_text("def read_log(path):\n    return path.name\n")
    (gap / "diagnose.py").write_text(diagnose)
    return folder


def test_another_checkouts_diagnosis_is_run_not_ours(case, tmp_path):
    told = (
        "def diagnose(robot, logs, references, seed, threads):\n"
        "    return {'verdict': 'none', 'message': f'{logs} {references} {robot[-9:]} {threads}'}\n"
    )
    answer, seconds = diagnose_folder(case, package(tmp_path / "other", told))
    assert answer == {"verdict": "none", "message": "['0_log.parquet'] [] robot.xml 1"}
    assert seconds >= 0


def test_a_diagnosis_that_raises_or_dies_or_hangs_is_an_error(case, tmp_path):
    head = "def diagnose(robot, logs, references, seed, threads):\n    "
    raised, _ = diagnose_folder(case, package(tmp_path / "a", head + "raise ValueError('no')\n"))
    assert raised["verdict"] == "error"
    assert "ValueError: no" in raised["message"]
    died, _ = diagnose_folder(case, package(tmp_path / "b", head + "import os; os._exit(3)\n"))
    assert died["verdict"] == "error"
    slow = package(tmp_path / "c", head + "import time; time.sleep(60)\n")
    (case / "answer.json").unlink()
    hung, seconds = diagnose_folder(case, slow, longest=1.0)
    assert (hung["verdict"], seconds) == ("error", 1.0)


def test_our_own_diagnosis_refuses_a_case_without_torques_in_words(case):
    answer, _ = diagnose_folder(case)
    assert answer["verdict"] == "error"
    json.dumps(answer)


def test_a_folder_without_the_package_is_refused(case, tmp_path):
    with pytest.raises(InputError, match="holds no hyperleg_design"):
        diagnose_folder(case, tmp_path)
