"""Total mass, mass of a limb and standing height."""

from __future__ import annotations

import mujoco
import pytest

from hyperleg_design.robot.kinematics.dimensions import (
    limb_mass,
    standing_height,
    total_mass,
    zero_height,
)
from hyperleg_design.robot.kinematics.posture import default_angles
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.mass.mass_rows import mass_rows
from hyperleg_design.robot.mjcf import mujoco_model
from tests.robot.tree_files import SHIPPED


@pytest.fixture(scope="module", params=SHIPPED)
def design(request):
    return load_robot(request.param)


def test_mass_table_adds_up(design):
    rows = {row.name: row for row in mass_rows(design)}
    assert rows["robot"].mass == pytest.approx(float(total_mass(design)))
    assert rows["limb"].mass == pytest.approx(float(limb_mass(design)))
    assert rows["limb"].count == len(design.copies)
    links = [row for row in rows.values() if row.kind == "link"]
    assert sum(row.count * row.mass for row in links) == pytest.approx(rows["robot"].mass)


def test_the_robot_stands_on_its_pads(design):
    model = mujoco_model(design)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    pads = [i for i in range(model.ngeom) if model.geom_conaffinity[i] == 1]
    lowest = min(data.geom_xpos[i, 2] - model.geom_size[i, 0] for i in pads)
    if build_tree(design).floating:
        assert lowest == pytest.approx(0, abs=1e-9)
        zero = mujoco.MjData(model)
        mujoco.mj_kinematics(model, zero)
        assert model.body_pos[1, 2] == pytest.approx(float(zero_height(design)))
    assert model.qpos_spring.shape
    tree = build_tree(design)
    assert dict(
        zip([j.name for j in tree.moving], data.qpos[-len(tree.moving) :], strict=True)
    ) == pytest.approx(default_angles(tree))


def test_the_height_of_a_tree_is_that_of_its_default_posture():
    design = load_robot("mini_cheetah")
    model = mujoco_model(design)
    assert standing_height(design) == pytest.approx(model.key_qpos[0, 2], abs=1e-9)
    assert standing_height(design) < zero_height(design) - 0.1
