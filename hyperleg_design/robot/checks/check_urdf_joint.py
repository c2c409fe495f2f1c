"""Whether a joint of a URDF can move: its type, axis and limits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from hyperleg_design.robot.checks.check_units import MOST_RADIANS
from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.checks.urdf_xml import check_origin, numbers, place_of

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")


def check_joint(joint: Any, names: set[str | None]) -> list[Finding]:
    """Check one joint of a URDF.

    Args:
        joint: the element.
        names: of all joints, one of which it may mimic.

    Returns:
        What is wrong with its type, axis, limits, mimicry and dynamics.
    """
    place, kind = place_of(joint), joint.get("type")
    findings = check_origin(joint, place)
    if kind not in JOINT_TYPES:
        return [
            *findings,
            Finding(
                "error", place, f"type is {kind!r}", f"expects one of {', '.join(JOINT_TYPES)}"
            ),
        ]
    if kind in ("revolute", "continuous", "prismatic", "planar"):
        findings += _axis(joint, place)
    if kind in ("revolute", "prismatic"):
        findings += _limit(joint, place, kind)
    mimic = joint.find("mimic")
    if mimic is not None and mimic.get("joint") not in names:
        findings.append(
            Finding(
                "error",
                place,
                f"mimics {mimic.get('joint')!r}, which is no joint",
                "name a joint of this robot",
            )
        )
    dynamics = joint.find("dynamics")
    for key in ("damping", "friction"):
        value = None if dynamics is None else dynamics.get(key)
        number = numbers(value, 1)
        if value is not None and (number is None or number[0] < 0):
            findings.append(
                Finding("error", place, f"{key} is {value!r}", "expects a number, zero or more")
            )
    return findings


def _axis(joint: Any, place: str) -> list[Finding]:
    axis = joint.find("axis")
    text = "1 0 0" if axis is None else axis.get("xyz", "1 0 0")
    direction = numbers(text, 3)
    if direction is None:
        return [Finding("error", place, f"axis is {text!r}", "expects three numbers")]
    length = float(np.linalg.norm(direction))
    if length < 1e-9:
        return [Finding("error", place, "axis is zero", "give the axis a direction")]
    if abs(length - 1) > 1e-3:
        return [
            Finding(
                "warning",
                place,
                f"axis has length {length:.4g}",
                "programs differ in what they make of that; use a unit vector",
            )
        ]
    return []


def _limit(joint: Any, place: str, kind: str) -> list[Finding]:
    limit = joint.find("limit")
    if limit is None:
        return [
            Finding(
                "error",
                place,
                "has no <limit>",
                f"a {kind} joint needs lower, upper, effort and velocity",
            )
        ]
    findings: list[Finding] = []
    ends = {key: numbers(limit.get(key, "0"), 1) for key in ("lower", "upper")}
    findings += [
        Finding("error", place, f"{key} is {limit.get(key)!r}", "expects a number")
        for key, value in ends.items()
        if value is None
    ]
    if ends["lower"] is not None and ends["upper"] is not None:
        findings += _range(float(ends["lower"][0]), float(ends["upper"][0]), place, kind)
    driven = {"effort": numbers(limit.get("effort"), 1)}
    driven["velocity"] = numbers(limit.get("velocity"), 1)
    passive = all(value is not None and value[0] == 0 for value in driven.values())
    if passive and not findings:
        return findings  # no motor drives this joint, such as a toe on a spring
    for key, unit in (("effort", "Nm or N"), ("velocity", "rad/s or m/s")):
        value = driven[key]
        if value is None or value[0] <= 0:
            findings.append(
                Finding(
                    "error",
                    place,
                    f"{key} is {limit.get(key)!r}",
                    f"expects a positive number in {unit}; at zero the joint cannot move",
                )
            )
    return findings


def _range(lower: float, upper: float, place: str, kind: str) -> list[Finding]:
    unit = "rad" if kind == "revolute" else "m"
    shown = f"range is {lower:.4g} .. {upper:.4g} {unit}"
    if lower > upper:
        return [
            Finding(
                "error", place, f"{shown}, reversed: no posture lies in it", "swap lower and upper"
            )
        ]
    if lower == upper:
        return [
            Finding(
                "error",
                place,
                f"{shown}, empty: the joint cannot move",
                "widen it, or make the joint fixed",
            )
        ]
    end = max(abs(lower), abs(upper))
    if kind == "revolute" and end > MOST_RADIANS:
        return []  # an error of its unit
    if kind == "revolute" and end > 2 * math.pi + 1e-6:
        return [
            Finding(
                "warning",
                place,
                f"{shown}, more than a turn",
                "check the unit: a URDF takes radians, a design's lower_deg and upper_deg degrees",
            )
        ]
    if not lower <= 0 <= upper:
        return [
            Finding(
                "warning",
                place,
                f"{shown}, so the zero posture cannot be reached",
                "programs start there; shift the joint's frame if you can",
            )
        ]
    return []
