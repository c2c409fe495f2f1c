"""MJCF files of which meshes are missing give the robot that their inertials describe."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.mjcf_meshes import compiled

TETRAHEDRON = "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def write(folder, inertial='<inertial pos="0 0 -0.1" mass="0.5" diaginertia="2e-3 2e-3 1e-3"/>'):
    """A body on which a shin hangs that is drawn, and touches, by meshes."""
    path = folder / "leg.xml"
    path.write_text(
        f"""<mujoco><compiler meshdir="assets" texturedir="assets"/>
        <default><default class="drawn"><geom type="mesh" material="grey"/></default></default>
        <asset><mesh name="shin" file="shin.obj"/><mesh file="toe.obj"/>
        <texture name="grain" type="2d" file="grain.png"/><material name="grey" texture="grain"/>
        <hfield name="hill" file="hill.png" size="1 1 1 1"/></asset>
        <worldbody><geom type="hfield" hfield="hill"/><body name="body"><freejoint/>
        <geom name="ball" size="0.02" mass="2"/><body name="shank" pos="0 0 -0.1">
        <joint name="knee" axis="0 1 0" range="-60 60"/>{inertial}
        <geom class="drawn" name="touch" mesh="shin"/><geom class="drawn" mesh="toe" mass="0"/>
        </body></body></worldbody>
        <contact><pair geom1="touch" geom2="ball"/></contact></mujoco>"""
    )
    return path


def test_missing_meshes_are_left_out_with_what_uses_them(tmp_path):
    model = compiled(write(tmp_path), "leg.xml", meshes=False)
    assert (model.ngeom, model.nmesh, model.npair) == (1, 0, 0)
    assert np.allclose(model.body("shank").mass, 0.5)
    assert np.allclose(model.body("shank").ipos, [0, 0, -0.1])


def test_a_missing_mesh_is_refused_by_its_name_unless_it_may_be_missing(tmp_path):
    with pytest.raises(InputError, match=r"<mesh file> = 'shin\.obj': is missing.*--no-meshes"):
        compiled(write(tmp_path), "leg.xml")


def test_meshes_that_are_there_stay(tmp_path):
    path = write(tmp_path, inertial="")
    (tmp_path / "assets").mkdir()
    for name in ("shin.obj", "toe.obj"):
        (tmp_path / "assets" / name).write_text(TETRAHEDRON)
    model = compiled(path, "leg.xml", meshes=False)
    assert (model.ngeom, model.nmesh) == (3, 2)
    assert np.allclose(model.body("shank").mass, 1000 * 0.1**3 / 6)


@pytest.mark.parametrize("rule", ["auto", "true"])
def test_a_body_that_weighs_by_a_missing_mesh_is_named(rule, tmp_path):
    path = write(tmp_path, **({"inertial": ""} if rule == "auto" else {}))
    path.write_text(path.read_text().replace("<compiler", f'<compiler inertiafromgeom="{rule}"'))
    with pytest.raises(InputError, match=r"body shank: gets its mass from the mesh shin\.obj"):
        compiled(path, "leg.xml", meshes=False)


def test_a_drawing_outside_the_groups_that_weigh_may_be_missing(tmp_path):
    path = write(tmp_path, inertial='<geom size="0.01" mass="0.5" group="0"/>')
    text = path.read_text().replace("<compiler", '<compiler inertiagrouprange="0 1"')
    path.write_text(text.replace('mesh="shin"', 'mesh="shin" group="2"'))
    model = compiled(path, "leg.xml", meshes=False)
    assert np.allclose(model.body("shank").mass, 0.5)


def test_what_mujoco_refuses_is_told(tmp_path):
    path = write(tmp_path)
    path.write_text(path.read_text().replace('range="-60 60"', 'range="x"'))
    with pytest.raises(InputError, match="MuJoCo does not compile it"):
        compiled(path, "leg.xml", meshes=False)
