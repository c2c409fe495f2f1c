"""Walks of our own simulator against its own model: nothing is wrong, and what an overlay adds is
found.
"""

import numpy as np
import pytest

from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.gap.inference.preparation import prepare
from hyperleg_design.gap.inference.thresholds import load_thresholds
from hyperleg_design.gap.logs.log import read_log
from hyperleg_design.gap.logs.recording import write_logs
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.playback.overlay import Overlay
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.robot.design import load_design


def walked(folder, alterations=None, *, trials=1):
    """Logs of a shipped policy's walks."""
    short = WalkProtocol(
        distance=6.0, trials=trials, time_limit=12.0, steady=Steady(begin=2.0, end=6.0)
    )
    return [
        read_log(path)
        for path in write_logs(
            folder / "logs", [evaluate("walk-toe-0", short, threads=1, alterations=alterations)]
        )
    ]


def left(folder, logs):
    """Root mean square of each row that no nuisance parameter explains, over its floor."""
    from hyperleg_design.gap.inference.judge import Judge

    subject = load_subject(folder / "logs" / logs[0].metadata.robot, logs)
    ready = prepare([condition(log, subject) for log in logs], [], load_thresholds())
    judge = Judge(ready.base, load_thresholds(), 1)
    rows = judge.rows(judge.nothing.held.bare)[: len(ready.base.samples.rows)]
    return {
        (row.residual_name, row.name): float(rows[i]) ** 0.5
        for i, row in enumerate(ready.base.samples.rows)
    }


def test_a_simulated_walk_has_no_gap_to_its_own_model(tmp_path):
    found = left(tmp_path, walked(tmp_path))
    assert {residual_name for residual_name, _ in found} == {
        "base",
        "control",
        "drive",
        "ground",
        "motion",
        "transmission",
    }
    assert max(found.values()) < 1.1, found


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
    logs = walked(tmp_path, overlay.alterations(load_design("toe")), trials=2)
    found = diagnose(tmp_path / "logs" / logs[0].metadata.robot, logs, threads=2)
    assert [(cause.effect, cause.location) for cause in found.causes] == [(effect, location)]
    assert found.causes[0].parameters[parameter].value == pytest.approx(value, rel=0.1)


@pytest.mark.slow
def test_a_small_push_that_repeats_shows_in_the_balance_of_the_base_alone(tmp_path):
    """8 N on a robot of 350 N: taken from what the feet are said to bear, as a push from outside is
    not.
    """
    from hyperleg_design.gap.inference.judge import Judge
    from hyperleg_design.gap.inference.shaping import of_base, tells

    (log,) = walked(tmp_path)
    push = 8.0 * np.clip(np.sin(2 * np.pi * 0.7 * log.time), 0, None) ** 6
    total = sum(np.maximum(log.signals[f"contact_force/{pad}_z"], 0.0) for pad in log.feet)
    shares = {
        pad: np.maximum(log.signals[f"contact_force/{pad}_z"], 0.0) / np.maximum(total, 1.0)
        for pad in log.feet
    }
    pushed = log.changed(
        signals={
            **log.signals,
            **{
                f"contact_force/{p}_y": log.signals[f"contact_force/{p}_y"] - s * push
                for p, s in shares.items()
            },
        }
    )
    rules, told = load_thresholds(), []
    for one in (log, pushed):
        subject = load_subject(tmp_path / "logs" / one.metadata.robot, [one])
        judge = Judge(prepare([condition(one, subject)], [], rules).base, rules, 1)
        told.append(of_base(judge))
        assert tells(rules, judge.nothing, told[-1]) == (one is pushed)
    assert judge.base.samples.rows[told[1][0].shape.row].name in (
        "force_y",
        "moment_x",
    )  # at the feet, far below the base
    assert told[1][0].gain > told[0][0].gain + 10
