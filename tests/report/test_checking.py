from __future__ import annotations

import pytest
import yaml

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.report.checking import check_paths, checks_text


def test_shipped_things_of_every_kind_are_good():
    found = check_paths(["hyperleg", "toe_removed", "RI70", "toe_mass"])
    assert [f["errors"] for f in found] == [0, 0, 0, 0]
    assert checks_text(found).count("good") == 4


def test_a_broken_sweep_is_found(tmp_path):
    path = tmp_path / "broken.yaml"
    path.write_text("design: hyperleg\nsampling: grid\naxes: {toe.mas: {values: [0.1, 0.2]}}\n")
    (found,) = check_paths([str(path)])
    assert found["errors"] == 1
    assert "toe.mas" in checks_text([found])
    assert "1 error, 0 warnings" in checks_text([found])


def test_a_broken_design_is_found(tmp_path):
    path = tmp_path / "broken.yaml"
    path.write_text("base: hyperleg\ntoe: {mass: -1}\n")
    (found,) = check_paths([str(path)])
    assert found["errors"] == 1
    assert "toe.mass" in checks_text([found])


def test_nothing_to_check_is_bad_input():
    with pytest.raises(InputError):
        check_paths([])


def test_every_file_is_checked_though_others_cannot_be(tmp_path):
    data = yaml.safe_load(resources.find("descriptions", "parallel_ankle").read_text())
    rod = next(iter(data["rods"].values()))
    rod["crank_end"] = [-0.001, 0.045, -0.12]  # a crank of 1 mm beside a lever of 50 mm
    short = tmp_path / "short.yaml"
    short.write_text(yaml.safe_dump(data))
    paths = ["nothing-here", str(tmp_path), str(short), "hyperleg"]
    results = check_paths(paths)
    assert [entry["path"] for entry in results] == paths
    assert [entry["errors"] for entry in results] == [1, 1, 1, 0]
    words = ("no such file", "is a folder", "does not reach in the posture hip_yaw 0 deg, ")
    for entry, word in zip(results, words, strict=False):
        assert word in checks_text([entry])


def test_equal_findings_in_one_line_are_told_as_such():
    findings = [
        {"severity": "warning", "place": place, "message": "odd", "remedy": ""}
        for place in ("joint left", "joint right")
    ]
    entry = {"path": "a.urdf", "errors": 0, "warnings": 2, "findings": findings}
    assert checks_text([entry]).splitlines() == [
        "a.urdf: 0 errors, 2 warnings, equal ones in one line",
        "  warning: joint left, joint right: odd",
    ]
