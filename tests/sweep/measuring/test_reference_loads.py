import numpy as np
import pytest

from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.mass.inertials import inertials
from hyperleg_design.robot.models import GRAVITY, rigid_body_model
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.robot.transmission import joint_names
from hyperleg_design.sweep.measuring import reference_loads
from hyperleg_design.sweep.measuring.reference_loads import StaticLoad

BASE = load_design("hyperleg")
DESIGNS = {
    "hyperleg": {},
    "long_heavy": {
        "thigh.length": 0.45,
        "toe.mass": 0.4,
        "foot.com": [0.04, 0.0, -0.03],
        "thigh.com_forward": 0.02,
    },
    "other_motors": {
        "actuators.knee.motor": "RI80",
        "actuators.hip_pitch.motor": "U8",
        "toe.length": 0.08,
    },
}


def make(name, variant):
    return ablate(BASE.with_values(DESIGNS[name]), variant)


def pinocchio_torque(design, load: StaticLoad, link: str):
    """Left-leg torques by gravity and contact in Pinocchio: g(q) - J^T F, at the point of the
    load.
    """
    import pinocchio as pin

    model = rigid_body_model(design)
    names = joint_names(design)
    q = model.neutral()
    hip, knee, ankle, toe = np.asarray(load.angles, float)
    angles = (
        dict.fromkeys(names, 0.0)
        | {"hip_pitch": hip, "knee": knee, "ankle_pitch": ankle}
        | ({"toe": toe} if "toe" in names else {})
    )
    q[7 : 7 + len(names)] = [angles[n] for n in names]
    q[7 + len(names) :] = [angles[n] for n in names]
    tau = np.array(pin.computeGeneralizedGravity(model.model, model.data, q))
    # the force's line of action is vertical, so the height of the point does not matter
    hip_x = model.frame_position(q, "left_thigh")[0]
    origin = model.frame_position(q, link)
    jacobian = model.frame_jacobian(q, link)
    arm = np.array([hip_x + float(load.pressure_point) - origin[0], 0.0, 0.0])
    force = np.array([0.0, 0.0, float(load.force)])
    wrench = np.concatenate([force, np.cross(arm, force)])
    return (tau - jacobian.T @ wrench)[6 : 6 + len(names)], model, q, tau


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("name", DESIGNS)
def test_squat_is_what_pinocchio_finds_in_the_sagittal_plane(name, variant):
    design = make(name, variant)
    load = reference_loads.squat(design, inertials(design))
    expected, model, q, _ = pinocchio_torque(design, load, "left_foot")
    sagittal = [joint_names(design).index(j) for j in ("hip_pitch", "knee", "ankle_pitch")]
    np.testing.assert_allclose(load.torque[sagittal], expected[sagittal], atol=1e-9)
    if "toe" in joint_names(design):
        assert load.torque[6] == pytest.approx(expected[6], abs=1e-9)
    # the robot is in balance: its centre of mass stands over the load
    ahead = model.center_of_mass(q)[0] - model.frame_position(q, "left_thigh")[0]
    assert ahead == pytest.approx(float(load.pressure_point), abs=1e-9)
    assert 2 * float(load.force) == pytest.approx(
        GRAVITY * sum(link.mass for link in model.tree.links), rel=1e-12
    )


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("name", DESIGNS)
def test_push_off_is_what_pinocchio_finds_in_the_sagittal_plane(name, variant):
    design = make(name, variant)
    load = reference_loads.push_off(design, inertials(design))
    moving = joint_names(design)
    expected, *_ = pinocchio_torque(
        design, load, "left_toe_plate" if "toe" in moving else "left_foot"
    )
    for joint in ("hip_pitch", "knee", "ankle_pitch", "toe"):
        if joint in moving:
            assert load.torque[moving.index(joint)] == pytest.approx(
                expected[moving.index(joint)], abs=1e-9
            )


def test_squat_keeps_knee_and_trunk_as_stated():
    load = reference_loads.squat(BASE, inertials(BASE))
    hip, knee, ankle, toe = load.angles
    assert knee == reference_loads.SQUAT_KNEE
    assert hip + knee + ankle == pytest.approx(0, abs=1e-15)  # the foot is flat
    assert toe == 0


def test_a_robot_that_no_lean_brings_over_its_foot_has_no_squat():
    design = BASE.with_values({"pelvis.com": [-1.0, 0.0, 0.0], "pelvis.mass": 150.0})
    assert np.isnan(reference_loads.squat(design, inertials(design)).torque[2])


def test_a_batch_equals_its_designs():
    rng = np.random.default_rng(5)
    batch = BASE.with_values(
        {"toe.mass": rng.uniform(0.1, 0.5, 4), "thigh.length": rng.uniform(0.3, 0.45, 4)}
    )
    for load in (reference_loads.squat, reference_loads.push_off):
        together = load(batch, inertials(batch))
        for i in range(4):
            alone = load(batch.take(i), inertials(batch.take(i)))
            np.testing.assert_allclose(together.torque[i], alone.torque, rtol=1e-12, atol=1e-12)
