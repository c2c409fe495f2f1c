import numpy as np
import pytest

from hyperleg_design.sweep.measuring import measures
from hyperleg_design.sweep.pareto import nondominated
from hyperleg_design.sweep.run import run_sweep
from hyperleg_design.sweep.space import sweep_from_mapping
from hyperleg_design.sweep.summary import base_values


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    definition = {
        "design": "hyperleg",
        "variants": ["toe", "toe_removed_matched"],
        "axes": {
            "foot.ball_length": {"values": [0.1, 0.12, 0.58, 0.6]},
            "ankle": {"paths": ["transmission.scale.ankle_pitch"], "values": [0.5, 1, 2]},
        },
        "objectives": ["push_off_heat", "single_joint_speed.ankle_pitch"],
        "set": {"thigh.length": 0.30},
    }
    return run_sweep(
        sweep_from_mapping(definition), tmp_path_factory.mktemp("summary") / "out", progress=False
    )


def test_counts(result):
    summary = result.summary
    assert (summary["samples"], summary["designs"], summary["rejected"]) == (
        12,
        24,
        0 + int((result.columns()["rejected"] != "").sum()),
    )
    assert sum(summary["rejected_because"].values()) == summary["rejected"]
    assert list(summary["rejected_because"]) == [
        "foot.ball_length: makes the foot longer than the leg; lengths are metres"
    ]


def test_ranges_are_of_the_table(result):
    columns = result.columns()
    for variant, ranges in result.summary["range"].items():
        for column, (low, median, high) in ranges.items():
            values = columns[column][columns["variant"] == variant]
            assert (low, median, high) == (
                np.nanmin(values),
                np.nanmedian(values),
                np.nanmax(values),
            )
    missing = set(result.summary["range"]["toe"]) - set(
        result.summary["range"]["toe_removed_matched"]
    )
    assert missing == {c for c in measures.columns(result.sweep.measures) if c.endswith(".toe")}


def test_fronts_are_those_of_each_variant(result):
    columns = result.columns()
    for variant, front in result.summary["front"].items():
        rows = columns["variant"] == variant
        values = np.stack(
            [columns["push_off_heat"][rows], columns["single_joint_speed.ankle_pitch"][rows]], -1
        )
        expected = columns["sample"][rows][nondominated(values, ["low", "high"])]
        assert front == {"designs": len(expected), "samples": expected.tolist()}
        assert 0 < len(expected) < rows.sum()


def test_the_unchanged_design(result):
    expected = measures.evaluate(result.sweep.base, ["push_off_heat"])["push_off_heat"][0]
    assert base_values(result.sweep, "toe")["push_off_heat"] == expected
    assert result.summary["base"]["toe"]["push_off_heat"] == expected
