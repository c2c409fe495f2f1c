"""Verbs on designs: what they print and write."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hyperleg_design import cli


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = cli.main(list(arguments))
    out, err = capsys.readouterr()
    return code, out, err


def test_analyze_prints_one_json_object(capsys):
    code, out, _ = run(capsys, "analyze", "--design", "hyperleg", "--json")
    found = json.loads(out)
    assert code == 0
    assert found["total_mass"] == pytest.approx(32.0, abs=1e-12)
    assert found["leg_mass"] == pytest.approx(8.27, abs=1e-12)
    assert found["leg_length"] == pytest.approx(0.786, abs=1e-12)
    assert found["height"] == pytest.approx(0.9586, abs=1e-12)
    assert found["max_joint_torque"]["knee"] == pytest.approx(212.0, rel=1e-3)
    assert found["single_joint_speed"]["knee"] == pytest.approx(10.5, abs=0.05)
    assert len(found["reduction"]["walking"]) == len(found["reflected_inertia"]) == 7
    assert found["zonotope_to_box_volume"] == pytest.approx(0.130, abs=5e-4)
    assert found["ablation_confound"]["toe_removed"]["max_joint_torque"][
        "ankle_pitch"
    ] == pytest.approx(76.3, abs=0.05)


@pytest.mark.parametrize("variant", ["toe", "toe_locked", "toe_removed_matched", "toe_removed"])
def test_analyze_takes_every_variant(capsys, variant):
    code, out, _ = run(capsys, "analyze", "--variant", variant, "--json")
    found = json.loads(out)
    assert code == 0
    assert found["variant"] == variant
    assert len(found["joints"]) == (7 if variant == "toe" else 6)


def test_set_is_repeatable_and_reaches_the_design(capsys):
    _, out, _ = run(
        capsys, "analyze", "--set", "toe.mass=0.3", "--set", "pelvis.mass=16.46", "--json"
    )
    assert json.loads(out)["total_mass"] == pytest.approx(33.16, abs=1e-12)


def test_a_file_of_parameters_is_applied_before_set(capsys, tmp_path: Path):
    overlay = tmp_path / "heavy.yaml"
    overlay.write_text(
        "toe: {mass: 0.5}\npelvis: {mass: {value: 10, label: assumed, source: test}}\n"
    )
    _, out, _ = run(
        capsys, "analyze", "--set-file", str(overlay), "--set", "toe.mass=0.3", "--json"
    )
    assert json.loads(out)["total_mass"] == pytest.approx(10 + 2 * (8.27 + 0.08), abs=1e-12)


def test_texts_for_people(capsys):
    for arguments, word in (
        (("analyze",), "13.0 %"),
        (("list",), "RI70"),
        (("list", "parameters"), "toe.mass"),
        (("version",), "mujoco"),
    ):
        code, out, _ = run(capsys, *arguments)
        assert code == 0
        assert word in out


def test_list_speaks_json(capsys):
    _, out, _ = run(capsys, "list", "motors", "--json")
    motors = json.loads(out)["motors"]
    assert len(motors) >= 11
    assert motors["RI70"]["power_constant"] == pytest.approx(24.7, abs=0.05)


def test_build_writes_a_robot_that_other_tools_load(capsys, tmp_path: Path):
    import mujoco
    import pinocchio

    code, out, _ = run(
        capsys, "build", "--set", "toe.mass=0.3", "--out", str(tmp_path / "robot"), "--json"
    )
    files = json.loads(out)["files"]
    assert code == 0
    urdf = next(f for f in files if f.endswith(".urdf"))
    mjcf = next(f for f in files if f.endswith(".xml"))
    assert pinocchio.computeTotalMass(
        pinocchio.buildModelFromUrdf(str(tmp_path / "robot" / urdf))
    ) == pytest.approx(32.16 - 15.46, abs=1e-9)
    assert mujoco.MjModel.from_xml_path(
        str(tmp_path / "robot" / mjcf)
    ).body_mass.sum() == pytest.approx(32.16, abs=1e-9)


def test_build_leaves_a_foreign_folder_alone(capsys, tmp_path: Path):
    (tmp_path / "thesis.txt").write_text("mine")
    code, _, err = run(capsys, "build", "--out", str(tmp_path))
    assert code == 2
    assert str(tmp_path) in err
    assert [p.name for p in tmp_path.iterdir()] == ["thesis.txt"]
