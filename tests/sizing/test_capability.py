import numpy as np
import pytest

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.robot.transmission import joint_from_motor, motor_names
from hyperleg_design.sizing.capability import capability_table, largest_force
from hyperleg_design.sizing.contacts import contact_kinematics, contact_points
from hyperleg_design.sizing.envelope import motor_envelope, torque_limits
from hyperleg_design.sizing.postures import POSTURES, posture

DESIGNS = variants(load_design())


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("direction", ["vertical", "forward"])
@pytest.mark.parametrize("name", POSTURES)
def test_result_is_feasible_by_hand(variant, direction, name):
    design = DESIGNS[variant]
    model = rigid_body_model(design)
    q = posture(design, name, model)
    found = largest_force(design, q, direction, model=model)
    _, jacobian = contact_kinematics(model, q)
    joints = joint_from_motor(design).shape[0]
    nothing = np.zeros(model.model.nv)
    balance = (
        model.inverse_dynamics(q, nothing, nothing)
        - np.einsum("piv,pi->v", jacobian, found.pad_force)
    )[6 : 6 + joints]
    np.testing.assert_allclose(joint_from_motor(design) @ found.motor_torque, balance, atol=1e-3)
    lower, upper = torque_limits(motor_envelope(design), np.zeros(len(motor_names(design))))
    assert np.all(found.motor_torque < upper + 1e-5)
    assert np.all(found.motor_torque > lower - 1e-5)
    assert np.max(np.linalg.norm(found.pad_force[:, :2], axis=1) - found.pad_force[:, 2]) < 1e-2
    assert found.binding
    np.testing.assert_allclose(found.pad_force.sum(0), found.force)


def test_linear_program_agrees():
    """With a pyramid of many sides in place of the cone, scipy's linear solver finds the same
    force, from inside.
    """
    from scipy.optimize import linprog

    design = DESIGNS["toe"]
    model = rigid_body_model(design)
    q = posture(design, "mid_squat", model)
    found = largest_force(design, q, model=model)
    _, jacobian = contact_kinematics(model, q)
    nothing = np.zeros(model.model.nv)
    columns, matrix = slice(6, 13), joint_from_motor(design)
    edges = np.array(
        [[np.cos(t), np.sin(t), 1.0] for t in np.linspace(0, 2 * np.pi, 64, endpoint=False)]
    )
    loads = np.concatenate(
        [edges @ jacobian[p][:, columns] for p in range(6)]
    )  # one row an edge force
    limits = [(-p, p) for p in motor_envelope(design).peak_torque]
    result = linprog(
        np.concatenate([-np.ones(len(loads)), np.zeros(7)]),
        A_eq=np.hstack([loads.T, matrix]),
        b_eq=model.inverse_dynamics(q, nothing, nothing)[columns],
        bounds=[(0, None)] * len(loads) + limits,
    )
    assert -result.fun == pytest.approx(found.force[2], rel=2e-3)
    assert -result.fun <= found.force[2] * (1 + 1e-6)


def test_without_the_toe_motor_the_leg_is_weaker():
    standing = {k: largest_force(d, "standing").force[2] for k, d in DESIGNS.items()}
    assert standing["toe_removed_matched"] < 0.9 * standing["toe"]
    squat = {k: largest_force(d, "mid_squat").force[2] for k, d in DESIGNS.items()}
    assert squat["toe_removed_matched"] < 0.9 * squat["toe"]
    # flat on its sole a locked toe is worth as much as an active one: what counts is the motor
    assert squat["toe_locked"] == pytest.approx(squat["toe"], rel=1e-3)


def test_speed_narrows_the_envelope():
    design = DESIGNS["toe"]
    extending = np.array([0, 0, 0, -6.0, 0, 0, 0])
    assert (
        largest_force(design, "mid_squat", joint_velocity=extending).force[2]
        < largest_force(design, "mid_squat").force[2]
    )


def test_force_through_the_centre_of_mass():
    design = DESIGNS["toe"]
    model = rigid_body_model(design)
    q = posture(design, "mid_squat", model)
    found = largest_force(design, q, upright=True, model=model)
    arms = contact_points(model, q) - model.center_of_mass(q)
    np.testing.assert_allclose(np.cross(arms, found.pad_force).sum(0), 0.0, atol=1e-2)
    assert found.force[2] < largest_force(design, q, model=model).force[2]


def test_forward_at_a_given_load():
    found = largest_force(DESIGNS["toe"], "standing", "forward", vertical=313.9)
    assert found.force[2] == pytest.approx(313.9, rel=1e-5)
    assert 0 < found.force[0] <= 313.9 * (1 + 1e-6)


def test_right_leg_mirrors_left():
    left, right = (largest_force(DESIGNS["toe"], "mid_squat", side=s) for s in ("left", "right"))
    assert left.force[2] == pytest.approx(right.force[2], rel=1e-5)


def test_weak_motors_cannot_hold_the_leg():
    gears = {
        f"actuators.{a}.gear": 1
        for a in ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle", "toe")
    }
    weak = load_design(overrides={**gears, "masses.law": "fixed"})
    with pytest.raises(
        InfeasibleError, match=r"no contact force of the left foot lets its motors hold"
    ):
        largest_force(weak, "mid_squat", "forward", vertical=5000.0)


def test_table_has_a_row_for_each_question():
    rows = capability_table({"toe": DESIGNS["toe"]})
    assert [(r["posture"], r["direction"]) for r in rows] == [
        (p, d) for p in POSTURES for d in ("vertical", "forward")
    ]
    assert all(r["force"] > 0 for r in rows)


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"q": "handstand"}, "standing, mid_squat, toe_off"),
        ({"q": np.zeros(3)}, "shape"),
        ({"direction": "up"}, "vertical, forward"),
        ({"side": "middle"}, "left, right"),
        ({"joint_velocity": np.zeros(2)}, "joint_velocity"),
        ({"vertical": -1.0, "direction": "forward"}, "positive force"),
        ({"vertical": 100.0}, "forward direction"),
    ],
)
def test_bad_input(arguments, match):
    with pytest.raises(InputError, match=match):
        largest_force(DESIGNS["toe"], **{"q": "standing", **arguments})
