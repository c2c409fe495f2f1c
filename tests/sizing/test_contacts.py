import numpy as np
import pytest

from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.sizing.contacts import contact_kinematics, contact_points, sole_pads


@pytest.mark.parametrize("variant", VARIANTS)
def test_every_foot_has_three_rows_of_two(variant):
    model = rigid_body_model(load_design(variant=variant))
    pads = sole_pads(model.tree)
    assert [p.row for p in pads] == ["heel", "heel", "ball", "ball", "tip", "tip"] * 2
    assert [p.side for p in pads] == ["left"] * 6 + ["right"] * 6
    points = contact_points(model, model.neutral())
    np.testing.assert_allclose(points[:, 2], 0.0, atol=1e-12)
    by_row = {p.row: points[i, 0] for i, p in enumerate(pads)}
    assert by_row["heel"] < 0 < by_row["ball"] < by_row["tip"]


def test_points_are_those_of_mujoco(rng):
    import mujoco

    from hyperleg_design.robot.mjcf import mujoco_model

    design = load_design()
    model = rigid_body_model(design)
    other = mujoco_model(design)
    data = mujoco.MjData(other)
    q = model.neutral()
    q[7:] += rng.uniform(-0.3, 0.3, 14)
    data.qpos[:] = model.to_mujoco(q)[0]
    mujoco.mj_kinematics(other, data)
    found = contact_points(model, q)
    wanted = []
    for pad in sole_pads(model.tree):
        index = {"heel": 0, "ball": 2, "tip": 0}[pad.row] + int(pad.name[-1])
        geom = data.geom(f"{pad.link}_pad_{index}")
        wanted.append(geom.xpos - [0, 0, pad.radius])
    np.testing.assert_allclose(found, wanted, atol=1e-12)


def test_jacobian_is_the_material_velocity(rng):
    import pinocchio as pin

    model = rigid_body_model(load_design())
    q = model.neutral()
    q[7:] += rng.uniform(-0.3, 0.3, 14)
    v = rng.normal(size=model.model.nv)
    points, jacobian = contact_kinematics(model, q)
    step = 1e-6

    # the material point stays where it is in its link: follow it by hand
    def followed(time: float) -> np.ndarray:
        moved = pin.integrate(model.model, q, v * time)
        found = []
        for pad, point in zip(sole_pads(model.tree), points, strict=True):
            frame = model.model.getFrameId(pad.link)
            pin.framesForwardKinematics(model.model, model.data, q)
            inside = model.data.oMf[frame].actInv(point)
            pin.framesForwardKinematics(model.model, model.data, moved)
            found.append(model.data.oMf[frame].act(inside))
        return np.array(found)

    np.testing.assert_allclose(
        jacobian @ v, (followed(step) - followed(-step)) / (2 * step), atol=1e-6
    )
