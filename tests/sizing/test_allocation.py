import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.robot.transmission import joint_from_motor
from hyperleg_design.sizing.allocation import RIDGE, least_heat
from hyperleg_design.sizing.contacts import contact_kinematics
from hyperleg_design.sizing.envelope import motor_envelope, torque_limits
from hyperleg_design.sizing.postures import posture

WEIGHT = 32.0 * 9.81


def _problem(
    variant: str = "toe", wide: float = 1.0, acceleration: np.ndarray | None = None
) -> dict:
    design = load_design(variant=variant)
    model = rigid_body_model(design)
    q = posture(design, "mid_squat", model)
    a = np.zeros(model.model.nv)
    if acceleration is not None:
        a[:6] = acceleration
    envelope = motor_envelope(design)
    lower, upper = torque_limits(envelope, np.zeros((1, 2, len(envelope.peak_torque))))
    return {
        "required": model.inverse_dynamics(q, np.zeros(model.model.nv), a)[None],
        "contact_jacobian": contact_kinematics(model, q)[1][None],
        "bears": np.ones((1, 12), bool),
        "matrix": joint_from_motor(design),
        "lower": wide * lower,
        "upper": wide * upper,
        "power_constant": envelope.power_constant,
        "friction": 1.0,
        "weight": WEIGHT,
    }


def closed_form(problem: dict) -> tuple[np.ndarray, np.ndarray]:
    """Forces and motor torques of least heat with equalities only, from the KKT system."""
    jacobian = problem["contact_jacobian"][0]
    size, matrix = jacobian.shape[-1], problem["matrix"]
    joints, motors = matrix.shape
    loads = jacobian.reshape(-1, size).T
    drives = np.zeros((size, 2 * motors))
    for leg in range(2):
        drives[6 + leg * joints : 6 + (leg + 1) * joints, leg * motors : (leg + 1) * motors] = (
            matrix
        )
    both = np.hstack([loads, drives])
    heat = problem["power_constant"] * problem["upper"][0, 0] ** 2
    curve = np.concatenate(
        [
            np.full(loads.shape[1], RIDGE * 2 * heat.sum() / WEIGHT**2),
            np.tile(problem["power_constant"], 2),
        ]
    )
    scale = np.sqrt(curve)
    solution = (
        np.linalg.lstsq(both / scale, problem["required"][0], rcond=1e-14)[0] / scale
    )  # least norm in the heat's metric
    return solution[: loads.shape[1]].reshape(-1, 3), solution[loads.shape[1] :].reshape(2, motors)


@pytest.mark.parametrize("variant", VARIANTS)
def test_without_active_limits_it_is_the_kkt_solution(variant):
    problem = _problem(variant)
    force, torque = closed_form(problem)
    assert np.all(
        np.linalg.norm(force[:, :2], axis=1) < force[:, 2]
    )  # no limit is active, or the check would be none
    assert np.all(np.abs(torque) < problem["upper"][0])
    found = least_heat(**problem)
    np.testing.assert_allclose(found.motor_torque[0], torque, atol=2e-5)
    assert found.heat[0] == pytest.approx(np.sum(problem["power_constant"] * torque**2), rel=1e-5)
    assert not found.excess.any()
    assert not found.gap.any()


@settings(max_examples=12)
@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3))
def test_equations_of_motion_hold_and_forces_stay_in_their_cones(push):
    problem = _problem(acceleration=np.array([1.5 * push[0], push[1], 2 * push[2], 0, 0, 0]))
    found = least_heat(**problem)
    assert found.residual < 1e-6
    force = found.contact_force[0]
    assert force[:, 2].min() > -1e-5
    assert np.max(np.linalg.norm(force[:, :2], axis=1) - force[:, 2]) < 1e-4
    missing = (
        problem["required"][0, :6]
        - np.einsum("piv,pi->v", problem["contact_jacobian"][0], force)[:6]
    )
    np.testing.assert_allclose(missing, found.gap[0], atol=1e-6)


def test_no_allocation_is_cooler(rng):
    problem = _problem(acceleration=np.array([0.5, 0.3, 1.0, 0, 0, 0]))
    found = least_heat(**problem)
    jacobian, matrix = problem["contact_jacobian"][0], problem["matrix"]
    base = jacobian[:, :, :6].reshape(-1, 6).T
    null = np.linalg.svd(base)[2][6:]
    for step in rng.normal(size=(50, len(null))) @ null * 0.5:
        force = found.contact_force[0] + step.reshape(-1, 3)
        if np.any(np.linalg.norm(force[:, :2], axis=1) > force[:, 2]):
            continue
        joint = problem["required"][0, 6:] - np.einsum("piv,pi->v", jacobian, force)[6:]
        torque = np.linalg.solve(matrix, joint.reshape(2, -1).T).T
        assert np.sum(problem["power_constant"] * torque**2) >= found.heat[0] - 1e-3


def test_samples_do_not_mix():
    problems = [_problem(acceleration=np.array([x, 0, 0, 0, 0, 0.0])) for x in (0.0, 0.8)]
    stacked = ("required", "contact_jacobian", "bears", "lower", "upper")
    both = least_heat(
        **{
            k: np.concatenate([p[k] for p in problems]) if k in stacked else problems[0][k]
            for k in problems[0]
        }
    )
    for n, problem in enumerate(problems):
        np.testing.assert_allclose(
            both.motor_torque[n], least_heat(**problem).motor_torque[0], atol=1e-4
        )


def test_weak_motors_are_reported_by_how_much():
    problem = _problem(wide=0.05)
    found = least_heat(**problem)
    assert found.excess.max() > 0
    assert not found.gap.any()
    over = np.maximum(np.abs(found.motor_torque) - problem["upper"], 0)
    np.testing.assert_allclose(found.excess, over, atol=1e-4)
    assert found.residual < 1e-6
    with pytest.raises(InfeasibleError, match=r"sample 0 of 1 is beyond the robot: motors miss"):
        least_heat(**problem, allow_excess=False)


def test_no_contact_cannot_carry_the_weight():
    problem = _problem()
    problem["bears"] = np.zeros((1, 12), bool)
    found = least_heat(**problem)
    assert found.gap[0, 2] == pytest.approx(WEIGHT, rel=1e-4)
    assert not found.contact_force.any()


def test_slippery_floor_cannot_push_forward():
    problem = _problem(acceleration=np.array([3.0, 0, 0, 0, 0, 0])) | {"friction": 0.1}
    assert least_heat(**problem).gap[0, 0] == pytest.approx(32.0 * (3.0 - 0.981), rel=0.05)


def test_bad_shapes_and_numbers():
    with pytest.raises(InputError, match="shapes"):
        least_heat(**(_problem() | {"matrix": np.eye(6)}))
    with pytest.raises(InputError, match="friction"):
        least_heat(**(_problem() | {"friction": 0.0}))
