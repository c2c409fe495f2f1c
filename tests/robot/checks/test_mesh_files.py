"""Meshes of a URDF: where they are looked for, and what is said of missing ones."""

from __future__ import annotations

import pytest

from hyperleg_design.robot.checks.check_urdf import check_urdf
from hyperleg_design.robot.checks.mesh_files import is_there, missing_meshes
from hyperleg_design.robot.checks.urdf_xml import parse_xml
from tests.robot.checks.urdfs import GOOD


@pytest.fixture
def package(tmp_path):
    """A ROS package `arm` with a URDF and one mesh."""
    (tmp_path / "arm" / "urdf").mkdir(parents=True)
    (tmp_path / "arm" / "meshes").mkdir()
    (tmp_path / "arm" / "meshes" / "tip.stl").touch()
    return tmp_path / "arm" / "urdf" / "arm.urdf"


@pytest.mark.parametrize(
    ("name", "there"),
    [
        ("../meshes/tip.stl", True),
        ("meshes/tip.stl", False),
        ("tip.stl", False),
        ("package://arm/meshes/tip.stl", True),
        ("model://arm/meshes/tip.stl", True),
        ("package://renamed/meshes/tip.stl", True),
        ("package://arm/meshes/gone.stl", False),
        ("file:///gone/tip.stl", False),
        ("", False),
    ],
)
def test_a_mesh_is_looked_for_where_its_name_says(name, there, package):
    assert is_there(name, package) is there


def test_an_absolute_path_counts_from_the_root(package):
    mesh = package.parent.parent / "meshes" / "tip.stl"
    assert is_there(f"file://{mesh}", package)
    assert is_there(str(mesh), package)


def test_check_warns_of_meshes_of_packages_and_refuses_other_missing_ones(package):
    drawn = "".join(
        f'<visual><geometry><mesh filename="{name}"/></geometry></visual>'
        for name in ("package://arm/a.stl", "package://arm/a.stl", "package://arm/b.stl", "c.stl")
    )
    package.write_text(GOOD.replace('<link name="tip"/>', f'<link name="tip">{drawn}</link>'))
    root, _ = parse_xml(package)
    assert missing_meshes(root, package) == ["package://arm/a.stl", "package://arm/b.stl", "c.stl"]
    error, warning = check_urdf(package)
    assert (error.severity, "'c.stl'" in error.message) == ("error", True)
    assert (warning.severity, warning.place) == ("warning", "<mesh filename>")
    assert "2 files such as package://arm/a.stl" in warning.message
    assert "--no-meshes" in warning.remedy
    assert check_urdf(package, meshes=False) == []
