"""The blind cases of the benchmark: frozen, split in halves, named by what they are."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.validation.benchmark import blind_cases
from hyperleg_design.validation.benchmark.case import KINDS


@pytest.fixture(scope="module")
def cases():
    return blind_cases.blind_cases()


def test_names_are_unique_and_halves_are_equal(cases):
    assert len({case.name for case in cases}) == len(cases) == blind_cases.COUNT
    splits = [case.split for case in cases]
    assert splits.count("development") == splits.count("held out") == blind_cases.COUNT // 2


def test_kinds_of_a_trial_are_kinds_of_the_benchmark(cases):
    assert set(blind_cases.KINDS.values()) <= set(KINDS)
    for case in cases:
        words = case.name.split("-")
        assert case.kind == blind_cases.KINDS[words[-1]]
        assert (case.kind == "nothing") == case.about.endswith(", null")


def test_a_case_tells_its_truth_and_gives_its_files(monkeypatch):
    """The parts of a trial stand in for the simulation, which takes minutes."""
    log = SimpleNamespace(
        time=np.arange(3.0),
        signals={"position/hip": np.zeros(3)},
        metadata=SimpleNamespace(mapping=dict),
    )
    case = SimpleNamespace(robot="arm.xml", mjcf="<mujoco/>", logs=(log, log), references=(log,))
    wrong = {
        "effect": "payload",
        "location": "hand",
        "also": ["hand", "wrist"],
        "parameters": {"mass": 1},
        "listed": True,
    }
    wrongs = [wrong | {"multiple": 2.5}, wrong | {"multiple": 1.5}]

    monkeypatch.setattr(blind_cases, "_plans", lambda: [SimpleNamespace(plant="rig")])
    monkeypatch.setattr(blind_cases, "rig_case", lambda plan: case)
    monkeypatch.setattr(blind_cases, "describe", lambda case: {"wrongs": wrongs})
    material, truth = blind_cases.material(None, 0)
    assert material.robot == "<mujoco/>"
    assert (len(material.logs), len(material.references)) == (2, 1)
    assert truth.faults[0].places == ("hand", "wrist")
    assert truth.faults[0].parameters == {"mass": 1.0}
    assert truth.references
    assert not truth.visible  # one of the two is smaller than what a clean log leaves twice
