"""The nominal model of a robot, made to fit its logs."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.robot.build import build
from hyperleg_design.robot.design import load_design


def log_of(joints, **metadata):
    time = np.arange(50) * 0.01
    return Log("some", time, {f"position/{j}": np.sin(time) for j in joints}, Metadata(**metadata))


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
            [log_of(["left_knee"], torque_sensors=("left_neck",))],
            r"some: torque_sensors = 'left_neck': is no joint",
        ),
        (
            "hyperleg",
            [log_of(["left_knee"], torque_constant={"neck": 0.1})],
            r"some: torque_constant = 'neck': is no motor",
        ),
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


def test_a_motor_whose_joint_is_not_logged_is_told_with_the_joint(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(
        """<mujoco><worldbody><body><joint name="a"/><geom size="0.1"/><body><joint name="b"/>
        <geom size="0.1"/></body></body></worldbody><actuator><motor name="m_a" joint="a"/>
        <motor name="m_b" joint="b"/></actuator></mujoco>"""
    )
    log = log_of(["a"])
    torque = Log(log.name, log.time, log.signals | {"motor_torque/m_b": log.time}, log.metadata)
    with pytest.raises(InputError, match=r"some: motor = 'm_b': drives nothing.*held still: b"):
        load_subject(str(path), [torque])
