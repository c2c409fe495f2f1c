from functools import cache

import numpy as np
import pytest

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.robot.transmission import joint_from_motor, joint_names, motor_names
from hyperleg_design.sizing.contacts import contact_kinematics
from hyperleg_design.sizing.demand import Demand, demand, demands, joint_friction, required_forces
from hyperleg_design.sizing.motions.reference import reference_motion


@cache
def walked(variant: str) -> Demand:
    return demand(load_design(variant=variant), "walk")


@pytest.fixture(params=VARIANTS)
def walk(request) -> Demand:
    return walked(request.param)


def test_equations_of_motion_hold(walk):
    assert walk.allocation.residual < 1e-6
    assert not walk.allocation.gap.any()
    required = required_forces(walk.motion)
    joints = len(joint_names(walk.design))
    for n in range(0, len(required), 9):
        _, jacobian = contact_kinematics(walk.motion.model, walk.motion.q[n])
        given = np.einsum("piv,pi->v", jacobian, walk.allocation.contact_force[n])
        np.testing.assert_allclose(given[:6], required[n, :6], atol=1e-6)
        np.testing.assert_allclose(
            given[6:] + walk.joint_torque[n].ravel(), required[n, 6:], atol=1e-6
        )
    assert walk.joint_torque.shape[1:] == (2, joints)


def test_mujoco_agrees_on_the_inverse_dynamics(walk):
    import mujoco

    from hyperleg_design.robot.mjcf import mujoco_model

    model = walk.motion.model
    other = mujoco_model(walk.design, friction=False, floor=False)
    data = mujoco.MjData(other)
    bare = required_forces(walk.motion)
    bare[:, 6:] -= joint_friction(walk.design, walk.motion.joint_velocity).reshape(len(bare), -1)
    for n in range(0, len(bare), 17):
        state = model.to_mujoco(walk.motion.q[n], walk.motion.v[n], walk.motion.a[n])
        data.qpos[:], data.qvel[:], data.qacc[:] = state
        mujoco.mj_inverse(other, data)
        np.testing.assert_allclose(data.qfrc_inverse[6:], bare[n, 6:], atol=1e-7)
        # MuJoCo's force on the base is in world axes, here without rotation the same
        np.testing.assert_allclose(data.qfrc_inverse[:6], bare[n, :6], atol=1e-7)


def test_contact_forces_carry_the_weight_within_their_cones(walk):
    force = walk.allocation.contact_force
    weight = GRAVITY * sum(link.mass for link in walk.motion.model.tree.links)
    assert force[..., 2].sum(1).mean() == pytest.approx(weight, rel=1e-3)
    assert force[..., 2].min() > -1e-3
    assert (
        np.max(
            np.linalg.norm(force[..., :2], axis=-1) - walk.design.contact.friction * force[..., 2]
        )
        < 1e-2
    )
    assert not force[~walk.motion.contact].any()


def test_power_is_the_same_at_joints_and_motors(walk):
    at_joints = np.sum(walk.joint_torque * walk.motion.joint_velocity, (1, 2))
    np.testing.assert_allclose(walk.ledger.mechanical.sum(1), at_joints, atol=1e-8)
    assert walk.ledger.residual().max() < 1e-9


def test_work_over_a_stride_is_friction_alone(walk):
    """A steady stride gains no energy, the feet do not slip: motors give what joint friction
    takes.
    """
    friction = joint_friction(walk.design, walk.motion.joint_velocity) * walk.motion.joint_velocity
    assert float(walk.power.mechanical) == pytest.approx(
        float(friction.sum((1, 2)).mean()), rel=0.02
    )


def test_the_walk_lies_inside_every_envelope(walk):
    assert walk.beyond_share == 0
    assert walk.margin.min() > 0
    assert np.all(walk.lower <= walk.motor_torque)
    assert np.all(walk.motor_torque <= walk.upper)


def test_table_says_what_the_arrays_say(walk):
    rows = walk.table()
    assert [r["motor"] for r in rows] == list(motor_names(walk.design))
    for m, row in enumerate(rows):
        assert row["peak_torque"] == pytest.approx(np.abs(walk.motor_torque[..., m]).max())
        assert row["rms_torque"] == pytest.approx(
            np.sqrt((walk.motor_torque[..., m] ** 2).mean(0)).max()
        )
        assert row["margin"] == pytest.approx(walk.margin[..., m].min())
    assert sum(r["joule"] for r in rows) == pytest.approx(float(walk.power.joule))
    assert sum(r["joule"] for r in rows) == pytest.approx(walk.allocation.heat.mean())
    summary = walk.summary()
    mass = sum(link.mass for link in walk.motion.model.tree.links)
    assert summary["cost_of_transport"] == pytest.approx(
        summary["motor_side"] / (mass * GRAVITY * 1.33)
    )
    assert summary["cost_of_transport_battery"] > summary["cost_of_transport"]


def test_locking_the_toe_never_needs_less_than_its_motor_gives():
    """The same stance forces: seven motors on six joints are never hotter than six. The friction
    is held, of which the toe's motor has a part.
    """
    held = {"friction.law": "declared"}
    kept, gone = (
        demand(load_design(variant=v, overrides=held), "squat")
        for v in ("toe_locked", "toe_removed_matched")
    )
    assert float(kept.power.joule) < float(gone.power.joule)
    assert float(kept.power.mechanical) == pytest.approx(float(gone.power.mechanical), rel=1e-3)


def test_weak_motors_are_beyond():
    weak = load_design(
        overrides={"actuators.knee.gear": 4.0, "actuators.ankle.gear": 4.0, "masses.law": "fixed"}
    )
    motion = reference_motion(weak, "walk", samples=61)
    found = demand(weak, motion)
    assert 0 < found.beyond_share < 1
    assert found.margin.min() < 0
    with pytest.raises(InfeasibleError, match="beyond the robot"):
        demand(weak, motion, allow_excess=False)


def test_hop_needs_no_ground_in_flight():
    design = load_design()
    found = demand(design, reference_motion(design, "hop", samples=42))
    flying = ~found.motion.contact.any(1)
    assert not found.allocation.gap.any()
    assert not found.allocation.contact_force[flying].any()
    with pytest.raises(InputError, match="distance"):
        found.cost_of_transport()


def test_friction_opposes_motion():
    design = load_design()
    np.testing.assert_allclose(joint_friction(design, np.full(7, 10.0))[3], 5.59 + 0.10 * 10)
    np.testing.assert_allclose(
        joint_friction(design, -np.ones(7)), -joint_friction(design, np.ones(7))
    )


def test_several_designs_at_once():
    design = load_design()
    found = demands({"toe": design, "none": ablate(design, "toe_removed")}, "squat")
    assert found["none"].motor_torque.shape[-1] == 6
    assert found["toe"].motor_torque.shape[-1] == 7
    assert joint_from_motor(design).shape == (7, 7)


def test_motion_of_another_design_is_refused():
    design = load_design()
    with pytest.raises(InputError, match=r"was planned for hyperleg, variant toe_removed"):
        demand(design, reference_motion(ablate(design, "toe_removed"), "squat"))
    with pytest.raises(InputError, match="motor or battery"):
        walked("toe").cost_of_transport("wall")


def test_a_tree_has_no_planned_motion():
    with pytest.raises(InputError, match=r"mini_cheetah.*family.*HyperLeg's legs"):
        demand(load_robot("mini_cheetah"), "walk")
