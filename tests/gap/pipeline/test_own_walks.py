"""Walks of our own simulator against its own model: nothing is wrong, and what an overlay adds is
found.
"""

import pytest
import robots

from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.gap.logs.log import read_log
from hyperleg_design.gap.logs.recording import write_logs
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.playback.overlay import Overlay
from hyperleg_design.robot.design import load_design

UPRIGHT = "walk_upright-toe-1"
STEADY = "walk_guided-toe-0"
"""Still walks where an accelerometer is 0.8 m/s^2 off; all upright walks fall within 2.2 s."""


def walked(folder, alterations=None, *, trials=1, policy=UPRIGHT):
    """Logs of a shipped policy's walks."""
    short = WalkProtocol(
        distance=6.0, trials=trials, time_limit=12.0, steady=Steady(begin=2.0, end=6.0)
    )
    return [
        read_log(path)
        for path in write_logs(
            folder / "logs",
            [evaluate(policy, short, threads=1, alterations=alterations)],
        )
    ]


@pytest.mark.slow
def test_a_simulated_walk_has_no_gap_to_its_own_model(tmp_path):
    logs = walked(tmp_path)
    found = diagnose(tmp_path / "logs" / logs[0].metadata.robot, logs, threads=2)
    assert found.verdict == "none"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "location", "parameter", "value"),
    [
        ("viscous_friction", "left_knee", "damping", 2.0),
        ("torque_constant", "left_knee", "scale", 0.8),
        ("encoder_offset", "right_knee", "offset", 0.05),
        ("payload", "pelvis", "mass", 3.0),
        ("imu_bias", "imu", "accelerometer_x", 0.8),
        ("imu_bias", "imu", "gyro_y", 0.1),
        ("controller_gain", "left_knee", "stiffness_scale", 0.6),
        ("transmission_ratio", "left_knee", "scale", 1.1),
        ("command_delay", "left_knee", "delay", 0.01),
        ("link_mass", "left_thigh", "mass", 1.5),
    ],
)
def test_what_an_overlay_adds_is_found(tmp_path, effect, location, parameter, value):
    overlay = Overlay("hyperleg", {(effect, location): {parameter: value}}, {})
    policy = STEADY if parameter == "accelerometer_x" else UPRIGHT
    alterations = overlay.alterations(load_design("toe"))
    logs = walked(tmp_path, alterations, trials=2, policy=policy)
    assert all(log.time[-1] > 4.0 for log in logs), "the robot fell at once"
    found = diagnose(tmp_path / "logs" / logs[0].metadata.robot, logs, threads=2)
    assert [(cause.effect, cause.location) for cause in found.causes] == [(effect, location)]
    assert found.causes[0].parameters[parameter].value == pytest.approx(value, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "location", "parameter", "value"),
    [
        ("viscous_friction", "left_knee", "damping", 2.0),
        ("torque_constant", "left_knee", "scale", 0.8),
        ("payload", "pelvis", "mass", 3.0),
    ],
)
def test_forces_under_the_feet_need_not_be_logged(tmp_path, effect, location, parameter, value):
    overlay = Overlay("hyperleg", {(effect, location): {parameter: value}}, {})
    logs = walked(tmp_path, overlay.alterations(load_design("toe")), trials=2)
    blind = [robots.without(log, "contact_force") for log in logs]
    found = diagnose(tmp_path / "logs" / logs[0].metadata.robot, blind, threads=2)
    assert [(cause.effect, cause.location) for cause in found.causes] == [(effect, location)]
    closest = found.causes[0].parameters[parameter]
    assert closest.low <= value <= closest.high
