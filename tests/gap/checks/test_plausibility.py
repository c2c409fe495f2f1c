import numpy as np
import pytest
from rig import rig_log, spoiled

from hyperleg_design.gap.checks.plausibility import implausible
from hyperleg_design.gap.results.finding import ERROR, WARNING
from tests.gap.checks.implausible import Robot, errors, only


@pytest.mark.parametrize("seed", range(3))
def test_a_sound_log_is_left_alone(seed):
    assert implausible(rig_log(seed=seed), Robot()) == []


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
