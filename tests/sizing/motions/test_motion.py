"""What every planned motion must be true to, on every variant."""

from functools import cache

import numpy as np
import pytest

from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.robot.names import SIDES, VARIANTS
from hyperleg_design.sizing.contacts import contact_kinematics
from hyperleg_design.sizing.motions.motion import Motion, ground_wrench, zero_moment_offset
from hyperleg_design.sizing.motions.reference import MOTIONS, reference_motion
from hyperleg_design.sizing.motions.stair import StairPlan

CASES = [(v, m) for v in VARIANTS for m in MOTIONS if m != "hop" or v in ("toe", "toe_removed")]


@cache
def planned(variant: str, name: str) -> Motion:
    return reference_motion(
        load_design(variant=variant), name, samples=40 if name == "hop" else None
    )


@pytest.fixture(params=CASES, ids=lambda c: f"{c[0]}-{c[1]}")
def motion(request) -> Motion:
    return planned(*request.param)


def test_forward_kinematics_reproduce_the_planned_feet(motion):
    import pinocchio as pin

    model = motion.model
    for n in range(0, len(motion.time), 7):
        pin.forwardKinematics(model.model, model.data, motion.q[n], motion.v[n], motion.a[n])
        pin.updateFramePlacements(model.model, model.data)
        for leg, side in enumerate(SIDES):
            path, frame = motion.feet[leg], model.model.getFrameId(f"{side}_foot")
            place = model.data.oMf[frame]
            np.testing.assert_allclose(place.translation, path.position[0, n], atol=1e-9)
            np.testing.assert_allclose(
                np.arctan2(-place.rotation[2, 0], place.rotation[0, 0]), path.pitch[0, n], atol=1e-9
            )
            velocity = pin.getFrameVelocity(
                model.model, model.data, frame, pin.LOCAL_WORLD_ALIGNED
            ).vector
            np.testing.assert_allclose(velocity, path.twist(1, n), atol=1e-8)


def test_feet_bear_without_slipping_or_sinking(motion):
    levels = np.array([0.0, StairPlan().step_height]) if motion.name == "stair" else np.zeros(1)
    for n in range(len(motion.time)):
        points, jacobian = contact_kinematics(motion.model, motion.q[n])
        bears = motion.contact[n]
        assert points[:, 2].min() > -1e-9
        assert np.abs(jacobian[bears] @ motion.v[n]).max(initial=0) < 1e-8
        assert np.abs(points[bears, 2, None] - levels).min(-1).max(initial=0) < 1e-9


def test_velocities_are_those_of_the_positions(motion):
    import pinocchio as pin

    step, model = motion.time_step, motion.model.model
    inner = range(1, len(motion.time) - 1)
    moved = np.array(
        [pin.difference(model, motion.q[n - 1], motion.q[n + 1]) / (2 * step) for n in inner]
    )
    # central differences err by step^2 / 6 of the third derivative, and feet change phase with a
    # jump in that
    jerk = np.abs(np.gradient(motion.a, step, axis=0)).max(0)
    assert np.all(np.abs(moved - motion.v[1:-1]) < step**2 * (jerk + 5) + 2e-3)
    gained = (motion.v[2:] - motion.v[:-2]) / (2 * step)
    mostly = np.median(np.abs(gained - motion.a[1:-1]), 0)
    assert np.all(mostly < 0.05 * (np.abs(motion.a).max(0) + 1))


def test_periodic_motions_close(motion):
    if not motion.periodic:
        return
    first, last = motion.q[0].copy(), motion.q[-1] + 0.0
    first[0] += motion.distance
    assert np.abs(first - last).max() <= 1.5 * motion.time_step * (np.abs(motion.v).max() + 1e-9)


def test_centre_of_pressure_is_the_planned_one_inside_the_loaded_pads(motion):
    force, moment = ground_wrench(motion.model, motion.q, motion.v, motion.a)
    stands = motion.contact.any(1) & (force[:, 2] > 1.0)
    offset = zero_moment_offset(force[stands], moment[stands], motion.pressure[stands])
    assert np.abs(offset).max() < 3e-3
    if motion.name == "stair":
        return  # feet on two levels have no polygon of support
    for n in np.flatnonzero(stands):
        points, _ = contact_kinematics(motion.model, motion.q[n])
        assert inside(motion.pressure[n, :2], points[motion.contact[n], :2]) < 5e-3, (
            n,
            motion.time[n],
        )


def inside(point: np.ndarray, corners: np.ndarray) -> float:
    """How far a point lies outside the convex hull of the corners [m]."""
    directions = np.linspace(0, 2 * np.pi, 180, endpoint=False)
    normals = np.stack([np.cos(directions), np.sin(directions)], -1)
    return float(np.max(normals @ point - np.max(normals @ corners.T, 1)))


def test_knees_bend_forward_and_joints_stay_in_range(motion):
    limits = motion.model.design.joints
    for index, name in enumerate(
        j.name.removeprefix("left_")
        for j in motion.model.tree.moving[: motion.joint_position.shape[2]]
    ):
        joint = getattr(limits, name)
        angles = np.rad2deg(motion.joint_position[..., index])
        assert angles.min() >= joint.lower_deg - 1e-6
        assert angles.max() <= joint.upper_deg + 1e-6
    assert motion.joint_position[..., 3].min() > np.deg2rad(5)


def test_ground_carries_the_weight_on_average(motion):
    force, _ = ground_wrench(motion.model, motion.q, motion.v, motion.a)
    weight = GRAVITY * sum(link.mass for link in motion.model.tree.links)
    # a motion that repeats, or starts and ends at rest, gains no momentum
    assert force[:, 2].mean() == pytest.approx(weight, rel=2e-3)
    assert abs(force[:, 0].mean()) < 0.01 * weight


def test_says_what_it_assumes(motion):
    assert motion.assumptions
    assert any("assumed" in text for text in motion.assumptions.values())
