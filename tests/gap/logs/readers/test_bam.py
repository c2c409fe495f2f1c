import json
import math

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.readers import open_log
from hyperleg_design.gap.logs.readers.bam import SERVOS


def recording(ticks=200, kp=200, volts=7.4, motor="xl330", **changes):
    """What the servo's own model writes."""
    servo, entries = SERVOS["xl330"], []
    for i in range(ticks):
        t = i * 0.005
        goal, position, speed = math.sin(3 * t), 0.8 * math.sin(3 * t), 2.4 * math.cos(3 * t)
        counts = round(servo.full_duty * servo.error_gain * kp * (goal - position))
        entries.append(
            {
                "timestamp": t,
                "position": position,
                "speed": speed,
                "load": counts % 2**16,
                "input_volts": volts,
                "temp": 30,
                "goal_position": goal,
                "torque_enable": i >= 5,
            }
            | changes
        )
    return {
        "mass": 0.49,
        "length": 0.1,
        "kp": kp,
        "vin": 7.4,
        "motor": motor,
        "trajectory": "sin",
        "entries": entries,
    }


def write(path, content):
    path.write_text(json.dumps(content))
    return path


def test_recorded_current_agrees_with_declared_gains(tmp_path):
    (log,) = open_log(write(tmp_path / "2026-01-15_run.json", recording()))
    stiffness, damping = log.metadata.gains["servo"]
    error = log.signals["position_target/servo"] - log.signals["position/servo"]
    asked = stiffness * error - damping * log.signals["velocity/servo"]
    given = log.metadata.torque_constant["servo"] * log.signals["motor_current/servo"]
    np.testing.assert_allclose(given[5:], asked[5:], atol=1e-3)
    assert np.isnan(error[:5]).all()
    assert log.metadata.base == "fixed"
    assert log.metadata.extra["mass"] == 0.49
    assert log.metadata.session == "xl330_0.49_0.1_2026-01-15"


def test_other_motors_have_no_gains(tmp_path):
    (log,) = open_log(write(tmp_path / "run.json", recording(motor="mx64")))
    assert log.metadata.gains == {}
    assert not log.motors or "motor_current/servo" not in log.signals
    assert any("nothing is known of the drive" in remark for remark in log.metadata.remarks)


def test_own_current_and_side_file(tmp_path):
    path = write(tmp_path / "run.json", recording(present_current=2**16 - 100))
    (tmp_path / "run.meta.json").write_text(
        json.dumps({"joints": ["hinge"], "gains": {"hinge": [1, 0.1]}, "role": "reference"})
    )
    (log,) = open_log(path)
    np.testing.assert_allclose(log.signals["motor_current/hinge"], -0.1)
    assert (log.metadata.gains["hinge"], log.metadata.role) == ((1, 0.1), "reference")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"mass": 1}, "entries.*missing"),
        (recording(1), "at least two"),
        (recording(position="far"), r"entries\[0\].position = 'far'"),
        ({"mass": 1, "entries": [1, 2]}, r"entries.timestamp.*missing"),
        ([1], "entries"),
    ],
)
def test_bad_files(tmp_path, content, message):
    with pytest.raises(InputError, match=message):
        open_log(write(tmp_path / "run.json", content))


def test_cut_file(tmp_path):
    (tmp_path / "run.json").write_text(json.dumps(recording())[:5000])
    with pytest.raises(InputError, match="no whole JSON"):
        open_log(tmp_path / "run.json")


def test_xl330(real_logs):
    found = open_log(real_logs / "xl330_pendulum")
    assert [log.metadata.extra["kp"] for log in found] == [100, 100, 200, 200, 400, 400, 800, 800]
    assert len({log.metadata.session for log in found}) == 1
    for log in found:
        stiffness, damping = log.metadata.gains["servo"]
        error = log.signals["position_target/servo"] - log.signals["position/servo"]
        duty = np.abs(error) * stiffness / log.metadata.supply["servo"][1]
        free = duty < 0.9  # the firmware's duty is not clipped
        asked = (
            stiffness * error * log.signals["battery_voltage"] / 7.4
            - damping * log.signals["velocity/servo"]
        )
        given = log.metadata.torque_constant["servo"] * log.signals["motor_current/servo"]
        # the duty that the firmware reports is the one that goal, position and gain make, a
        # read-out later
        assert np.std((given - asked)[free]) < 0.03 * np.std(given)
        assert np.polyfit(asked[free], given[free], 1)[0] == pytest.approx(1, abs=0.02)
