from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.gap.inference.detectors.sinking import SINKS
from hyperleg_design.gap.playback.evidence import Evidence
from hyperleg_design.report.gap.left import friction, hints

UNITS = ("Nm",), ("rad/s",)


def shown(left: np.ndarray, speed: np.ndarray) -> list[Evidence]:
    time = np.arange(len(left)) * 0.01
    return [
        Evidence(
            "run",
            "motion",
            ("hinge",),
            time,
            left[:, None],
            0 * left[:, None],
            speed[:, None],
            *UNITS,
        )
    ]


SPEED = 3 * np.sin(np.arange(3000) * 0.02)
SHAPE = {"location": "hinge", "says": "a torque that drifts with time", "closed_beyond": 0.9}


def test_friction_is_recovered() -> None:
    fit = friction(shown(0.3 * np.sign(SPEED) + 0.1 * SPEED, SPEED), 0)
    assert fit.constant == pytest.approx(0.3, rel=0.05)
    assert fit.viscous == pytest.approx(0.1, rel=0.1)
    assert fit.share > 0.99


def test_friction_of_a_slide_is_a_force() -> None:
    (part,) = shown(0.3 * np.sign(SPEED), SPEED)
    (sentence,) = hints([SHAPE], [replace(part, units=("N",), speed_units=("m/s",))])
    assert sentence.startswith("Left at hinge: a force that goes with its speed.")
    assert " N and " in sentence
    assert " Ns/m would" in sentence


def test_what_drives_the_joint_is_no_friction() -> None:
    assert friction(shown(-0.3 * np.sign(SPEED), SPEED), 0).share == 0.0


def test_plain_friction_is_said_once_instead_of_other_shapes() -> None:
    (sentence,) = hints([SHAPE, SHAPE], shown(0.3 * np.sign(SPEED), SPEED))
    assert sentence.startswith("Left at hinge: a torque that goes with its speed. Plain friction")


def test_feet_that_sink_are_said_beside_what_is_left() -> None:
    sinks = {"shape": SINKS, "location": "toe", "says": "sinks by 4 mm", "closed_beyond": 0.9}
    sentences = hints([sinks, SHAPE], shown(0.3 * np.sign(SPEED), SPEED))
    assert sentences[0] == "toe sinks by 4 mm."
    assert sentences[1].startswith("Left at hinge")


def test_another_shape_is_said_where_friction_does_not_fit() -> None:
    rng = np.random.default_rng(0)
    assert hints([SHAPE], shown(rng.normal(size=3000), SPEED)) == [
        "Left at hinge: a torque that drifts with time."
    ]


def test_friction_of_all_joints_is_said_before_a_shape_of_the_whole_robot() -> None:
    other = 2 * np.cos(np.arange(3000) * 0.013)
    left = np.column_stack([0.3 * np.sign(SPEED), 0.1 * np.sign(other)])
    time, speed = np.arange(3000) * 0.01, np.column_stack([SPEED, other])
    both = [
        Evidence(
            "run",
            "motion",
            ("hip", "knee"),
            time,
            left,
            0 * left,
            speed,
            ("Nm",) * 2,
            ("rad/s",) * 2,
        )
    ]
    tilt = {"location": "robot", "says": "gravity from elsewhere", "closed_beyond": 0.9}
    (sentence,) = hints([tilt], both)
    assert sentence.startswith("Left: torques that go with the joints' speeds. Plain friction")
    assert "hip 0.31 Nm" in sentence
    assert "knee 0.1 Nm" in sentence
    assert hints([tilt], []) == ["Left: gravity from elsewhere."]
