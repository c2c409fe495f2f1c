from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.ablation import ablate, variants
from hyperleg_design.robot.mjcf import STAND, TIME_STEP, mjcf, mujoco_model, mujoco_spec
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.robot.names import JOINTS, MOTORS


@pytest.fixture(scope="module")
def model(hyperleg) -> mujoco.MjModel:
    return mujoco_model(hyperleg)


def dense(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    matrix = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, matrix)
    return matrix


def standing(model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(STAND).id)
    mujoco.mj_forward(model, data)
    return data


def test_names(model):
    sides = ("left", "right")
    joints = [f"{side}_{name}" for side in sides for name in JOINTS]
    motors = [f"{side}_{name}" for side in sides for name in MOTORS]
    assert [model.joint(i).name for i in range(model.njnt)] == ["floating_base", *joints]
    assert [model.actuator(i).name for i in range(model.nu)] == motors
    assert [model.tendon(i).name for i in range(model.ntendon)] == motors
    assert [model.key(i).name for i in range(model.nkey)] == [STAND]
    sensors = {model.sensor(i).name for i in range(model.nsensor)}
    assert {"gyro", "accelerometer", "velocimeter", "base_orientation"} <= sensors
    assert {f"{j}_{kind}" for j in joints for kind in ("position", "velocity")} <= sensors
    assert {f"{m}_motor_{kind}" for m in motors for kind in ("velocity", "torque")} <= sensors
    assert {f"{side}_{link}_load" for side in sides for link in ("foot", "toe_plate")} <= sensors
    assert model.opt.timestep == TIME_STEP


def test_masses(hyperleg, model):
    assert model.body_mass.sum() == pytest.approx(32.0, abs=1e-12)
    assert mujoco_model(hyperleg.with_values({"toe.mass": 0.3})).body_mass.sum() == pytest.approx(
        32.16, abs=1e-12
    )


@pytest.mark.parametrize("variant", ["toe", "toe_locked", "toe_removed_matched", "toe_removed"])
def test_standing_pads_touch_the_floor(hyperleg, variant):
    model = mujoco_model(variants(hyperleg)[variant])
    data = standing(model)
    pads = [i for i in range(model.ngeom) if "_pad_" in model.geom(i).name]
    assert len(pads) == 12
    heights = np.array([data.geom_xpos[i, 2] - model.geom_size[i, 0] for i in pads])
    assert heights.min() == pytest.approx(0, abs=1e-12)
    np.testing.assert_allclose(
        heights, 0, atol=1e-6
    )  # knee and ankle angles cancel: the sole is flat
    for joint in JOINTS if variant == "toe" else JOINTS[:-1]:
        assert data.joint(f"left_{joint}").qpos == pytest.approx(
            np.deg2rad(getattr(hyperleg.joints, joint).default_deg), abs=1e-12
        )


def test_tendons_are_the_columns_of_m(hyperleg, model, rng):
    matrix = transmission.joint_from_motor(hyperleg)
    data = mujoco.MjData(model)
    data.qvel[:] = rng.normal(size=model.nv)
    mujoco.mj_forward(model, data)
    for leg in range(2):
        joint_velocity = data.qvel[6 + 7 * leg : 13 + 7 * leg]
        expected = transmission.motor_velocity(matrix, joint_velocity)
        np.testing.assert_allclose(data.ten_velocity[7 * leg : 7 * leg + 7], expected, rtol=1e-13)
        measured = [
            data.sensor(f"{('left', 'right')[leg]}_{m}_motor_velocity").data[0] for m in MOTORS
        ]
        np.testing.assert_allclose(measured, expected, rtol=1e-13)


@pytest.mark.parametrize("variant", ["toe", "toe_locked", "toe_removed"])
def test_motor_torques_reach_the_joints(hyperleg, variant, rng):
    design = variants(hyperleg)[variant]
    model = mujoco_model(design)
    matrix, peak = transmission.joint_from_motor(design), motor_arrays(design).peak_torque
    joints, motors = matrix.shape
    data = mujoco.MjData(model)
    torque = rng.uniform(-1, 1, 2 * motors) * np.tile(peak[:motors], 2)
    data.ctrl[:] = torque
    mujoco.mj_forward(model, data)
    expected = np.concatenate([matrix @ torque[:motors], matrix @ torque[motors:]])
    np.testing.assert_allclose(
        data.qfrc_actuator[6 : 6 + 2 * joints], expected, rtol=1e-12, atol=1e-12
    )
    np.testing.assert_allclose(data.qfrc_actuator[:6], 0, atol=1e-12)
    np.testing.assert_array_equal(model.actuator_ctrlrange[:motors, 1], peak[:motors])


def test_rotors_are_seen_through_tendons_only(hyperleg, model):
    assert not model.dof_armature.any()
    with_rotors = dense(model, standing(model))
    bare = mujoco_model(hyperleg)
    bare.tendon_armature[:] = 0
    difference = with_rotors - dense(bare, standing(bare))
    matrix, rotor = transmission.joint_from_motor(hyperleg), motor_arrays(hyperleg).rotor_inertia
    expected = np.zeros((20, 20))
    expected[6:13, 6:13] = expected[13:, 13:] = transmission.reflected_inertia(matrix, rotor)
    np.testing.assert_allclose(difference, expected, atol=1e-13)
    assert difference[9, 10] == pytest.approx(-31.11 * 33.05e-7 * (26.69 * 2 + 19.23), rel=1e-9)


@pytest.mark.parametrize("motor", MOTORS[3:])
@pytest.mark.parametrize("posture", ["walking", "standing"])
def test_every_motor_below_the_knee_pushes_the_foot_away(hyperleg, motor, posture):
    """At every joint a positive motor torque acts towards a greater distance from the hip: knee on
    ankle, ankle on ball, toe on tip.
    """
    design = hyperleg.with_values(
        {"transmission.posture": posture, "joints.toe.default_deg": -20.0}
    )  # toe bent up, as at push-off
    model = mujoco_model(design)
    data = standing(model)
    toe = data.body("left_toe_plate")
    points = {
        "knee": ("left_shank", data.body("left_ankle_cross").xpos),
        "ankle_pitch": ("left_foot", toe.xpos),
        "toe": ("left_toe_plate", toe.xpos + toe.xmat.reshape(3, 3) @ [0.065, 0, 0]),
    }
    column = transmission.joint_from_motor(design)[:, MOTORS.index(motor)]
    for joint, (body, point) in points.items():
        jacobian = np.zeros((3, model.nv))
        mujoco.mj_jac(model, data, jacobian, None, point, model.body(body).id)
        away = point - data.body("left_thigh").xpos
        lengthening = away @ jacobian[:, model.joint(f"left_{joint}").dofadr[0]]
        torque = column[JOINTS.index(joint)]
        assert torque * lengthening > 0 or torque == 0, joint
    assert column[JOINTS.index("knee")] != 0


def test_all_of_them_together_make_the_robot_push_off(hyperleg):
    model = mujoco_model(hyperleg, friction=False, floor=False)
    model.opt.gravity[:] = 0
    data = standing(model)
    lengths = []
    for _ in range(4):
        mujoco.mj_kinematics(model, data)
        lengths.append(
            [
                np.linalg.norm(data.body(f"{s}_ankle_cross").xpos - data.body(f"{s}_thigh").xpos)
                for s in ("left", "right")
            ]
        )
        for side in ("left", "right"):
            for motor in MOTORS[3:]:
                data.actuator(f"{side}_{motor}").ctrl = 0.2
        mujoco.mj_step(model, data)
    assert np.all(np.diff(lengths, axis=0)[1:] > 0)


def test_friction_is_the_designs_or_none(hyperleg, model):
    np.testing.assert_allclose(
        model.dof_frictionloss[6:13], [3.30, 3.30, 3.30, 5.59, 2.09, 2.20, 0.88]
    )
    np.testing.assert_allclose(model.dof_damping[6:13], [0.08, 0.08, 0.08, 0.10, 0.10, 0.10, 0.10])
    free = mujoco_model(hyperleg, friction=False)
    assert not free.dof_frictionloss.any()
    assert not free.dof_damping.any()


def test_only_pads_touch_the_floor(hyperleg, model):
    for index in range(model.ngeom):
        geom = model.geom(index)
        touches = bool(model.geom_contype[index] | model.geom_conaffinity[index])
        assert touches == ("_pad_" in geom.name or geom.name == "floor")
    data = standing(model)
    for _ in range(20):
        mujoco.mj_step(model, data)
    assert 4 <= data.ncon <= 12
    assert np.all(np.isfinite(data.qpos))
    weight = sum(
        float(data.sensor(f"{s}_{link}_load").data[0])
        for s in ("left", "right")
        for link in ("foot", "toe_plate")
    )
    assert 0.3 * 32 * 9.81 < weight < 3 * 32 * 9.81


def test_without_a_floor(hyperleg):
    names = [g.name for g in mujoco_spec(hyperleg, floor=False).geoms]
    assert "floor" not in names


def test_text_compiles_to_the_same_model(hyperleg):
    design = ablate(
        hyperleg.with_values({"thigh.length": 1 / 3, "actuators.knee.motor": "RI80"}), "toe_locked"
    )
    model, again = mujoco_model(design), mujoco.MjModel.from_xml_string(mjcf(design))
    for field in (
        "body_mass",
        "body_pos",
        "jnt_range",
        "jnt_axis",
        "tendon_armature",
        "wrap_prm",
        "geom_pos",
        "geom_size",
        "actuator_ctrlrange",
        "key_qpos",
    ):
        np.testing.assert_allclose(
            getattr(again, field), getattr(model, field), rtol=1e-14, atol=1e-15, err_msg=field
        )
    assert [again.sensor(i).name for i in range(again.nsensor)] == [
        model.sensor(i).name for i in range(model.nsensor)
    ]


def test_writing_leaves_mujocos_precision_alone(hyperleg):
    mjcf(hyperleg)
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(size=[1 / 3, 0, 0])
    assert "0.333333 " in spec.to_xml() or '0.333333"' in spec.to_xml()


def test_a_batch_has_no_model(hyperleg):
    with pytest.raises(InputError, match="batch"):
        mujoco_model(hyperleg.with_values({"toe.mass": np.array([0.2, 0.3])}))


def test_a_passive_toe_is_pulled_to_its_default_posture_by_its_spring_alone(hyperleg):
    passive = ablate(hyperleg.with_values({"toe.stiffness": 12.0}), "toe_passive")
    made = mujoco_model(passive)
    data = standing(made)
    data.joint("left_toe").qpos = -0.3
    mujoco.mj_forward(made, data)
    force = np.zeros(made.nv)
    force[made.joint("left_toe").dofadr[0]] = 12.0 * 0.3
    np.testing.assert_allclose(data.qfrc_spring, force, atol=1e-12)
    toes = [made.joint(f"{side}_toe").id for side in ("left", "right")]
    moved = [made.wrap_objid[i] for i in range(made.nwrap)]
    assert not set(toes) & set(moved)
    active = mujoco_model(hyperleg)
    assert not active.jnt_stiffness.any()
    assert active.body_mass.sum() == pytest.approx(made.body_mass.sum(), abs=1e-9)
