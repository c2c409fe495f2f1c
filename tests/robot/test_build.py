from __future__ import annotations

import csv
import errno
import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.robot.build import build
from hyperleg_design.robot.check import check_file
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.parameters import values as parameters


def everything(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


@pytest.fixture(scope="module")
def heavy_toe():
    return load_design("hyperleg", overrides=["toe.mass=0.3"])


@pytest.fixture(scope="module")
def built(heavy_toe, tmp_path_factory) -> Path:
    return build(heavy_toe, tmp_path_factory.mktemp("build") / "robot")


def test_the_files(built):
    assert set(everything(built)) == {
        "hyperleg.urdf",
        "hyperleg.xml",
        "design.yaml",
        "tree.yaml",
        "robot.urdf.xacro",
        "masses.csv",
        "masses.md",
        "manifest.json",
        ".hyperleg",
    }


def test_32_16_kg_in_other_programs(built):
    """Loaded by programs that know nothing of this package."""
    code = (
        "import sys, pinocchio, mujoco; u, x = sys.argv[1:];"
        "print(pinocchio.computeTotalMass(pinocchio.buildModelFromUrdf(u, "
        "pinocchio.JointModelFreeFlyer())));"
        "print(mujoco.MjModel.from_xml_path(x).body_mass.sum()); print('hyperleg_design' in "
        "sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, built / "hyperleg.urdf", built / "hyperleg.xml"],
        capture_output=True,
        text=True,
        check=True,
    )
    first, second, loaded = done.stdout.split()
    assert float(first) == pytest.approx(32.16, abs=1e-9)
    assert float(second) == pytest.approx(32.16, abs=1e-9)
    assert loaded == "False"


def test_yourdfpy_loads_it(built):
    import yourdfpy

    assert yourdfpy.URDF.load(str(built / "hyperleg.urdf")).num_actuated_joints == 14


def test_nothing_is_wrong_with_what_we_write(built):
    for name in ("hyperleg.urdf", "hyperleg.xml", "design.yaml"):
        assert check_file(built / name) == []


@pytest.mark.parametrize("variant", ["toe", "toe_removed_matched"])
def test_the_resolved_design_builds_the_same_robot(heavy_toe, variant, tmp_path):
    from hyperleg_design.robot.ablation import ablate

    design = ablate(heavy_toe, variant)
    first = build(design, tmp_path / "first")
    again = load_design(first / "design.yaml")
    one, two = parameters.leaves(design), parameters.leaves(again)
    assert all(np.array_equal(one[p], two[p]) for p in one)
    assert dict(again.origins) == dict(design.origins)
    assert again.origins["toe.mass"] == parameters.Origin("user", "--set")
    assert again.origins["foot.mass"] == parameters.Origin("paper", "Table I")
    second = build(again, tmp_path / "second")
    a, b = everything(first), everything(second)
    assert {n for n in a if a[n] != b[n]} <= {
        "manifest.json"
    }  # which says where the design was read from


def test_the_same_bytes_twice(heavy_toe, built, tmp_path):
    assert everything(build(heavy_toe, tmp_path / "robot")) == everything(built)


def test_xacro_makes_the_urdf_without_this_package(built):
    xacro = Path(sys.executable).with_name("xacro")
    done = subprocess.run(
        [xacro, "robot.urdf.xacro", "tree:=tree.yaml"],
        cwd=built,
        capture_output=True,
        text=True,
        check=True,
    )
    body = done.stdout[done.stdout.index("<robot") :]
    written = (built / "hyperleg.urdf").read_text()
    assert body.split() == written[written.index("<robot") :].split()


def test_the_manifest_tells_the_truth(built, heavy_toe):
    manifest = json.loads((built / "manifest.json").read_text())
    assert manifest["total_mass"] == pytest.approx(32.16, abs=1e-12)
    assert manifest["versions"]["mujoco"] == mujoco.__version__
    assert manifest["versions"]["pin"] == pin.__version__
    files = everything(built)
    assert set(manifest["sha256"]) == set(files) - {"manifest.json", ".hyperleg"}
    for name, checksum in manifest["sha256"].items():
        assert hashlib.sha256(files[name]).hexdigest() == checksum


def test_the_mass_table(built):
    with (built / "masses.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert sum(
        int(r["count"]) * float(r["mass_kg"]) for r in rows if r["kind"] == "link"
    ) == pytest.approx(32.16, abs=1e-12)
    text = (built / "masses.md").read_text()
    lines = [line for line in text.splitlines() if line.startswith("|")]
    assert len(lines) == len(rows) + 2
    assert len({len(line) for line in lines}) == 1
    assert "32.160" in text
    assert "-0.0," not in text


def test_a_name_of_ones_own(tmp_path, write):
    path = write("tall.yaml", "base: hyperleg\nthigh: {length: 0.4}\n")
    built = build(load_design(path), tmp_path / "out")
    assert (built / "tall.urdf").is_file()
    assert '<robot name="tall"' in (built / "robot.urdf.xacro").read_text()


def test_a_batch_cannot_be_built(heavy_toe, tmp_path):
    with pytest.raises(InputError, match="batch"):
        build(heavy_toe.with_values({"toe.mass": np.array([0.2, 0.3])}), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_foreign_folder_is_left_alone(heavy_toe, tmp_path):
    (tmp_path / "thesis.tex").write_text("mine")
    with pytest.raises(OutputError, match="did not write"):
        build(heavy_toe, tmp_path)
    assert everything(tmp_path) == {"thesis.tex": b"mine"}


@pytest.mark.parametrize("call", range(4))
def test_a_full_disk_leaves_the_old_robot(heavy_toe, hyperleg, tmp_path, monkeypatch, call):
    build(hyperleg, tmp_path / "robot")
    before, calls, sync = everything(tmp_path), [], os.fsync

    def full(handle: int) -> None:
        calls.append(handle)
        if len(calls) > 2 * call:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        sync(handle)

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError, match=r"robot/.*No space left on device"):
        build(heavy_toe, tmp_path / "robot")
    assert everything(tmp_path) == before
