from dataclasses import replace

import numpy as np
import pytest
from rig import rig_log, spoiled

from hyperleg_design.gap.checks.plausibility import implausible
from hyperleg_design.gap.results.finding import ERROR, WARNING


class Robot:
    """As much of a subject as this looks at."""

    joints = motors = motor_aliases = ("hip", "knee")
    motor_from_joint, motor_scale = np.eye(2), {}
    position_low, position_high = np.array([-1.0, -1.0]), np.array([1.0, 1.0])


def errors(log, subject=None):
    return [(f.signal, f.what) for f in implausible(log, subject) if f.severity == ERROR]


@pytest.mark.parametrize("seed", range(3))
def test_a_sound_log_is_left_alone(seed):
    assert implausible(rig_log(seed=seed), Robot()) == []


def only(found, signal, word):
    assert [s for s, _ in found] == [signal], found
    assert word in found[0][1]


def test_velocity_in_degrees_or_rpm():
    only(errors(spoiled(rig_log(), velocity__hip=np.degrees)), "velocity/hip", "deg/s")
    only(errors(spoiled(rig_log(), velocity__hip=lambda v: v * 30 / np.pi)), "velocity/hip", "rpm")


def test_position_in_degrees():
    found = errors(spoiled(rig_log(), position__hip=np.degrees))
    assert {s for s, _ in found} >= {"velocity/hip", "position_target/hip"}
    assert all("degrees" in what for _, what in found if "gains" not in what)


def test_everything_in_degrees():
    changes = {
        f"{kind}__{joint}": np.degrees
        for kind in ("position", "velocity", "position_target")
        for joint in ("hip", "knee")
    }
    found = implausible(spoiled(rig_log(), **changes), Robot())
    assert {f.signal for f in found if f.severity == ERROR} >= {
        "position/hip",
        "motor_torque_command/hip",
    }


def test_gains_in_degrees():
    log = rig_log(gains={"hip": (20 * np.pi / 180, np.pi / 180), "knee": (20.0, 1.0)})
    only(errors(log, Robot()), "motor_torque_command/hip", "gains look like Nm/deg")
    unknown = [f for f in implausible(log) if "Nm/deg" in f.what]
    assert [f.severity for f in unknown] == [WARNING]
    assert "gear" in unknown[0].remedy


def test_a_gear_of_57_is_no_wrong_unit_and_a_motor_that_is_mounted_the_other_way_is_no_wrong_sign():
    class Geared(Robot):
        motor_from_joint = np.diag([1 / 57.3, -1.0])

    turned = {
        f"{kind}__hip": lambda v: v / 57.3 for kind in ("motor_torque", "motor_torque_command")
    }
    turned |= {f"{kind}__knee": np.negative for kind in ("motor_torque", "motor_torque_command")}
    log = spoiled(
        rig_log(),
        **{key: change for key, change in turned.items() if rig_log().has(*key.split("__"))},
    )
    assert not [f for f in implausible(log, Geared()) if "gains ask for" in f.what]
    assert {f.severity for f in implausible(log, Robot()) if "gains ask for" in f.what} == {
        ERROR,
        WARNING,
    }


def test_milliamps():
    found = errors(spoiled(rig_log(), motor_current__knee=lambda c: c * 1000))
    assert {s for s, _ in found} == {"motor_current/knee"}
    alone = spoiled(rig_log(torque_constant={}), motor_current__knee=lambda c: c * 1000)
    assert {s for s, _ in errors(alone)} == {"motor_current/knee"}


@pytest.mark.parametrize("kind", ["velocity", "position_target", "position"])
def test_swapped_joints(kind):
    log = rig_log()
    swapped = spoiled(
        log,
        **{
            f"{kind}__hip": log.signals[f"{kind}/knee"],
            f"{kind}__knee": log.signals[f"{kind}/hip"],
        },
    )
    found = errors(swapped)
    assert found
    assert all("swapped" in f.remedy for f in implausible(swapped) if f.severity == ERROR)


def test_flipped_signs():
    only(errors(spoiled(rig_log(), velocity__hip=np.negative)), "velocity/hip", "against the rate")
    assert ("position_target/hip", "runs against its position") in errors(
        spoiled(rig_log(), position_target__hip=np.negative)
    )


def test_a_load_may_push_a_joint_against_its_target():
    log = rig_log()
    names = [
        f"{kind}__hip"
        for kind in ("joint_torque", "motor_torque", "motor_torque_command", "motor_current")
        if log.has(kind, "hip")
    ]
    silent = spoiled(
        log,
        position_target__hip=np.negative,
        **{name: lambda v: np.full_like(v, np.nan) for name in names},
    )
    assert ("position_target/hip", "runs against its position") in errors(silent)
    walked = silent.changed(metadata=replace(silent.metadata, base="floating"))
    assert {f.severity for f in implausible(walked) if f.what == "runs against its position"} == {
        WARNING
    }
    stiffness, damping = log.metadata.gains["hip"]
    asked = stiffness * (
        -log.column("position_target/hip") - log.column("position/hip")
    ) - damping * log.column("velocity/hip")
    followed = spoiled(log, position_target__hip=np.negative, motor_torque__hip=lambda _: asked)
    assert not [f for f in implausible(followed) if f.what == "runs against its position"]


def test_stuck_sensors():
    only(
        errors(spoiled(rig_log(), velocity__hip=np.zeros_like)),
        "velocity/hip",
        "never changes though the joint moves",
    )
    assert ("position/hip", "never changes though the joint is driven") in errors(
        spoiled(rig_log(), position__hip=np.ones_like)
    )

    def freeze(values):
        values = values.copy()
        values[1000:1400] = values[1000]
        return values

    frozen = [
        f for f in implausible(spoiled(rig_log(), position__hip=freeze)) if "frozen" in f.what
    ]
    assert [(f.severity, f.signal) for f in frozen] == [(WARNING, "position/hip")]
    assert "2 s from 5 s" in frozen[0].what


def test_other_units():
    ones = np.ones(4000)
    log = spoiled(
        rig_log(),
        accelerometer__x=0 * ones,
        accelerometer__y=0 * ones,
        accelerometer__z=ones,
        battery_voltage=24000 * ones,
        motor_temperature__hip=300 * ones,
        gyro__x=500 * np.sin(np.arange(4000)),
    )
    assert {s for s, _ in errors(log)} == {
        "accelerometer",
        "battery_voltage",
        "motor_temperature/hip",
        "gyro/x",
    }
    turned = spoiled(
        rig_log(),
        base_orientation__w=ones,
        base_orientation__x=ones,
        base_orientation__y=0 * ones,
        base_orientation__z=0 * ones,
    )
    assert {s for s, _ in errors(turned)} == {"base_orientation"}


def test_logs_of_other_robots():
    log = rig_log()

    class Other(Robot):
        joints = ("shoulder", "elbow")

    assert "another robot" in errors(log, Other())[0][1]

    class Near(Robot):
        joints = ("hip", "knees")

    found = [f.what for f in implausible(log, Near()) if f.severity == WARNING]
    assert any("knee (knees?)" in what for _, what in errors(log, Near()))
    assert any("without positions: knees" in what for what in found)

    class Small(Robot):
        position_low, position_high = np.array([-0.1, -1.0]), np.array([0.1, 1.0])

    assert "beyond the robot's range" in errors(log, Small())[0][1]


def test_real_logs_hold_no_errors(real_logs):
    from hyperleg_design.gap.logs.readers import open_log

    for folder in ("xl330_pendulum", "so101_arm", "go2_air"):
        for log in open_log(real_logs / folder):
            assert [f for f in implausible(log) if f.severity == ERROR] == [], log.name


def test_axes_of_an_accelerometer_told_in_turn_are_no_wrong_unit():
    log = rig_log()
    ticks = np.arange(len(log.time))
    turns = {
        f"accelerometer__{axis}": np.where(ticks % 3 == i, 9.81 * (axis == "z"), np.nan)
        for i, axis in enumerate("xyz")
    }
    assert not errors(spoiled(log, **turns))
    assert {s for s, _ in errors(spoiled(log, **{k: v / 9.81 for k, v in turns.items()}))} == {
        "accelerometer"
    }
