"""Robustness by one command: files, curves and figure of a short case."""

from __future__ import annotations

import json

import pandas as pd
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.report.walks.robustness_page import CURVES, FIGURE, TRIALS, run_robustness


def test_two_layouts_over_two_conditions(trainings, tmp_path):
    policies = [
        trainings / name / "policy.onnx"
        for name in ("walk_upright-toe-0", "walk_upright-toe_removed_matched-0")
    ]
    points = run_robustness(
        policies,
        tmp_path / "out",
        conditions=["floor_friction", "uneven_floor"],
        trials=2,
        protocol=WalkProtocol(distance=1.0, time_limit=0.8, steady=Steady(begin=0.5)),
        levels={"floor_friction": (0.8, 0.4), "uneven_floor": (0.0, 0.02)},
        workers=1,
        progress=False,
    )
    assert len(points) == 2 * 2 * 2 * 2  # conditions, levels, layouts, measures
    arrived = [p for p in points if p["measure"] == "arrived"]
    assert {p["variant"] for p in arrived} == {"toe", "toe_removed_matched"}
    levels = {(p["condition"], p["level"], p["confidence"]) for p in points}
    assert levels == {
        ("floor_friction", 0.8, 0.95),
        ("floor_friction", 0.4, 0.95),
        ("uneven_floor", 0.0, 0.95),
        ("uneven_floor", 0.02, 0.95),
    }
    assert all(p["mean"] == 0.0 and p["trials"] == 2 for p in arrived)  # they only stand
    assert json.loads((tmp_path / "out" / CURVES).read_text()) == points
    assert len(pd.read_parquet(tmp_path / "out" / TRIALS)) == 2 * 2 * 2 * 2
    assert (tmp_path / "out" / FIGURE).stat().st_size > 10_000


def test_nothing_to_evaluate_is_refused(tmp_path):
    with pytest.raises(InputError, match="expects ONNX files"):
        run_robustness([], tmp_path / "out")
