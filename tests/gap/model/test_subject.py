import numpy as np
import pytest
import robots

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.model.subject_build import subject_of
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.robot.build import build
from hyperleg_design.robot.design import load_design


def log_of(joints, **metadata):
    time = np.arange(50) * 0.01
    return Log("some", time, {f"position/{j}": np.sin(time) for j in joints}, Metadata(**metadata))


def test_our_design_has_its_own_numbers():
    design = load_design("hyperleg")
    subject = load_subject("hyperleg")
    from hyperleg_design.robot.models import rigid_body_model
    from hyperleg_design.robot.transmission import joint_from_motor

    np.testing.assert_allclose(
        subject.joint_from_motor, np.kron(np.eye(2), joint_from_motor(design))
    )
    np.testing.assert_allclose(
        subject.armature, rigid_body_model(design).reflected[6:, 6:], atol=1e-12
    )
    assert subject.base == "floating"
    assert not subject.one_to_one
    assert subject.feet == ("left_foot", "right_foot")
    assert {subject.feet[p.foot] for p in subject.pads} == set(subject.feet)


def test_what_we_build_reads_back_as_somebody_elses_robot(tmp_path):
    """Our own MJCF, through the door for foreign files: coupled motors on tendons included."""
    folder = build(load_design("hyperleg"), tmp_path / "robot")
    own, foreign = subject_of(load_design("hyperleg")), load_subject(folder / "hyperleg.xml")
    assert foreign.joints == own.joints
    assert foreign.motors == own.motors
    np.testing.assert_allclose(foreign.joint_from_motor, own.joint_from_motor, atol=1e-12)
    np.testing.assert_allclose(foreign.armature, own.armature, atol=1e-12)
    np.testing.assert_allclose(foreign.torque_limit, own.torque_limit)
    np.testing.assert_allclose(foreign.viscous, own.viscous)
    np.testing.assert_allclose(foreign.tree.inertial, own.tree.inertial, atol=1e-9)
    assert {p.name for p in foreign.pads} == {p.name for p in own.pads}
    assert foreign.feet == ("left_toe_plate", "right_toe_plate")


def test_servos_of_a_foreign_arm(robot_files):
    subject = load_subject(robot_files["arm"])
    assert subject.one_to_one
    assert subject.base == "fixed"
    assert subject.motor_aliases == ("a1", "a2", "a3", "a4", "a5", "a6")
    np.testing.assert_allclose(subject.gains[3], [500, 50])
    np.testing.assert_allclose(subject.torque_limit, [150, 150, 150, 28, 28, 28])
    np.testing.assert_allclose(np.diag(subject.armature), 0.1)
    np.testing.assert_allclose(subject.viscous, [1, 1, 0.5, 0.2, 0.2, 0.1])
    assert subject.position_high[0] == 6.28
    assert np.isinf(subject.position_high[1])


def test_gears_fold_into_the_joint(tmp_path):
    text = """<mujoco><worldbody><body><joint name="j"/><geom size="0.1"/></body></worldbody><actuator>
      <motor name="m" joint="j" gear="20" ctrlrange="-2 2"/></actuator></mujoco>"""  # noqa: E501
    (tmp_path / "geared.xml").write_text(text)
    subject = load_subject(tmp_path / "geared.xml")
    assert subject.joint_from_motor.tolist() == [[1.0]]
    assert subject.torque_limit.tolist() == [40.0]
    assert np.isnan(subject.gains).all()


def test_no_actuators_and_loose_things(tmp_path):
    text = """<mujoco><worldbody><body name="cup" pos="1 0 0"><freejoint/><geom size="0.05"/></body>
      <body name="a"><joint name="j"/><geom size="0.1"/><body name="b"><joint name="k"/><geom size="0.1"/></body></body></worldbody></mujoco>"""  # noqa: E501
    (tmp_path / "bare.xml").write_text(text)
    subject = load_subject(tmp_path / "bare.xml")
    assert subject.links == ("a", "b")
    assert subject.motors == subject.joints == ("j", "k")
    assert not subject.passive.any()
    assert np.isinf(subject.torque_limit).all()


def test_base_follows_the_metadata(tmp_path):
    fixed = load_subject("hyperleg", [log_of(["left_knee", "left_hip_pitch"], base="fixed")])
    assert fixed.base == "fixed"
    assert fixed.joints == ("left_hip_pitch", "left_knee")
    # the knee is driven by four motors of its leg, the hip by one; what hangs beyond is held still
    assert fixed.motors == (
        "left_hip_pitch",
        "left_knee",
        "left_ankle_left",
        "left_ankle_right",
        "left_toe",
    )
    assert "right_knee" in fixed.unlogged
    assert fixed.links[0] == "left_thigh"
    urdf = build(load_design("hyperleg"), tmp_path / "robot") / "hyperleg.urdf"
    assert load_subject(urdf).base == "fixed"
    floating = load_subject(urdf, [log_of(load_subject(urdf).joints, base="floating")])
    assert floating.base == "floating"
    assert floating.tree.base_inertial[0] > 1.0


def test_payload_hangs_on_link_or_joint_and_is_no_part_of_the_next_log(robot_files):
    from hyperleg_design.gap.model.rigid import inverse_dynamics

    joints = load_subject(robot_files["arm"]).joints
    by_link = load_subject(
        robot_files["arm"], [log_of(joints, payload={"flange": (2.0, 0.0, 0.05, 0.0)})]
    )
    by_joint = load_subject(
        robot_files["arm"], [log_of(joints, payload={"wrist_3": (2.0, 0.0, 0.15, 0.0)})]
    )
    assert by_link.model.body_mass.sum() == pytest.approx(
        load_subject(robot_files["arm"]).model.body_mass.sum() + 2.0
    )
    q, v, a = np.random.default_rng(0).normal(size=(3, 4, 6))
    np.testing.assert_allclose(
        inverse_dynamics(by_link, q, v, a), inverse_dynamics(by_joint, q, v, a), atol=1e-9
    )
    light = by_link.declare(Metadata(gains={"elbow": (7.0, 1.0)}))
    assert light.model.body_mass.sum() == pytest.approx(by_link.model.body_mass.sum() - 2.0)
    assert light.gains[2].tolist() == [7.0, 1.0]
    assert by_link.gains[2].tolist() == [2000.0, 150.0]


def test_named_in_the_metadata_only(robot_files):
    subject = load_subject(
        None,
        [log_of(["swing"], robot=str(robot_files["pendulum"]), torque_constant={"servo": 0.8})],
    )
    assert subject.name == "pendulum"
    assert subject.torque_constant.tolist() == [0.8]


@pytest.mark.parametrize(
    ("robot", "logs", "said"),
    [
        (None, [], "is not named"),
        ("nobody.xml", [], "no such file"),
        ("hyperleg", [log_of(["left_knee", "lefd_knee"])], "did you mean left_knee"),
        ("hyperleg", [log_of(["j1", "j2"])], "another robot"),
        (
            "hyperleg",
            [log_of(["left_knee"], base="fixed"), log_of(["left_knee"], base="floating")],
            "differ",
        ),
        ("hyperleg", [log_of(["left_knee"], gains={"left_neck": (1.0, 1.0)})], "is no joint"),
        (
            "hyperleg",
            [log_of(["left_knee"], payload={"left_hat": (1.0, 0.0, 0.0, 0.0)})],
            "no such moving link",
        ),
    ],
)
def test_errors_name_what_is_wrong(robot, logs, said):
    with pytest.raises(InputError, match=said):
        load_subject(robot, logs)


def test_missing_meshes_matter_only_where_masses_follow_from_them(tmp_path):
    text = robots.PENDULUM.replace(
        '<inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.0006 0.0006 0.0001"/>',
        '<geom type="mesh" mesh="m"/>',
    )
    text = text.replace("<worldbody>", '<asset><mesh name="m" file="gone.stl"/></asset><worldbody>')
    (tmp_path / "p.xml").write_text(text)
    with pytest.raises(InputError, match="give each body an inertial"):
        load_subject(tmp_path / "p.xml")


def test_not_a_robot(tmp_path):
    (tmp_path / "x.urdf").write_text("<robot>")
    with pytest.raises(InputError, match="neither MJCF nor URDF"):
        load_subject(tmp_path / "x.urdf")
