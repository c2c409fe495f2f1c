from __future__ import annotations

from hyperleg_design.report.sweep.page import sweep_report
from hyperleg_design.sweep.run import run_sweep
from hyperleg_design.sweep.space import sweep_from_mapping


def test_the_page_stands_beside_the_table_and_is_whole_without_other_files(tmp_path):
    definition = {
        "description": "small",
        "design": "hyperleg",
        "sampling": "grid",
        "axes": {
            "toe.mass": {"low": 0.1, "high": 0.3, "steps": 3},
            "actuators.knee.gear": {"low": 6, "high": 8, "steps": 3},
        },
        "objectives": ["total_mass", "push_off_heat"],
    }
    result = run_sweep(sweep_from_mapping(definition), tmp_path / "out", progress=False)
    summary = sweep_report(result)
    html = (tmp_path / "out" / "index.html").read_text()
    assert summary["designs"] == 9
    assert html.count("plotly.js (basic - minified)") == 1
    assert '"toe.mass"' in html
    assert len(html) < 1_500_000


def test_designs_that_make_no_robot_are_counted_and_not_drawn(tmp_path):
    definition = {
        "design": "teaching_leg",
        "axes": {"links.shank.mass": {"values": [0.0, 0.3, 0.4]}},
        "objectives": ["total_mass", "max_joint_torque.knee"],
    }
    result = run_sweep(sweep_from_mapping(definition), tmp_path / "out", progress=False)
    report = sweep_report(result)
    assert report["rejected"] == sum(report["rejected_because"].values()) == 1
    html = (tmp_path / "out" / "index.html").read_text()
    assert "1 of 3 combinations make no robot" in html
    assert "2 designs" in html
