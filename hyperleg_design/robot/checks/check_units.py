"""Whether lengths, angles and speeds of a robot's joints look like other units than those that URDF
and MJCF use.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.checks.urdf_xml import ends_of, numbers, place_of

MOST_RADIANS = 4 * math.pi + 1e-6
"""End of a range past which it is taken for degrees [rad]."""
LARGEST_STEP = 5.0
"""Distance between joints past which it is taken for millimetres [m]."""
FASTEST = 250.0
"""Speed of a joint past which it is taken for degrees a second [rad/s]: the fastest of the robots
that are shipped turns at 118, and no robot of `example-robot-data` states one between 60 and this,
but for powers of ten, which stand for no limit."""
WORLD = "world"
"""Root link by which a URDF says that its robot is fixed to the ground."""


def check_step(place: str, parent: str | None, position: np.ndarray) -> list[Finding]:
    """Check how far a joint lies from that before it.

    Args:
        place: of the joint, for findings.
        parent: link that carries it; the world is as far as it likes.
        position: in the frame of that link [m], `(3,)`.

    Returns:
        An error past `LARGEST_STEP`; none otherwise.
    """
    step = float(np.linalg.norm(position))
    if step <= LARGEST_STEP or parent == WORLD:
        return []
    remedy = "looks like millimetres; URDF and MJCF use metres"
    return [Finding("error", place, f"is {step:.4g} m from {parent}", remedy)]


def check_ends(place: str, lower: float, upper: float) -> list[Finding]:
    """Check the range of a joint that turns.

    Args:
        place: of the joint, for findings.
        lower: end of its range [rad].
        upper: end of its range [rad].

    Returns:
        An error past `MOST_RADIANS`; none otherwise.
    """
    end = max(abs(lower), abs(upper))
    if end <= MOST_RADIANS:
        return []
    message = f"range is {lower:.4g} .. {upper:.4g} rad"
    return [Finding("error", place, message, "looks like degrees; give radians")]


def check_units(joint: Any) -> list[Finding]:
    """Check the units of a joint of a URDF.

    Args:
        joint: the element.

    Returns:
        Errors of its place and range, and a warning of its speed; numbers that cannot be read are
        left to other checks.
    """
    place, limit = place_of(joint), joint.find("limit")
    findings = check_step(place, ends_of(joint)[0], step_of(joint))
    if joint.get("type") != "revolute" or limit is None:
        return findings
    ends = [numbers(limit.get(key, "0"), 1) for key in ("lower", "upper")]
    lower, upper = (0.0 if end is None else float(end[0]) for end in ends)
    findings += check_ends(place, lower, upper)
    velocity = numbers(limit.get("velocity"), 1)
    speed = 0.0 if velocity is None else float(velocity[0])
    if FASTEST < speed < math.degrees(FASTEST) and not math.log10(speed).is_integer():
        message = f"velocity is {speed:.4g} rad/s, faster than a joint turns"
        remedy = f"looks like degrees a second ({math.radians(speed):.3g} rad/s)"
        findings.append(Finding("warning", place, message, remedy))
    return findings


def step_of(joint: Any) -> np.ndarray:
    """Read where a joint of a URDF lies.

    Args:
        joint: the element.

    Returns:
        Its place in the frame of the parent [m], `(3,)`; zero where it has none that can be read.
    """
    origin = joint.find("origin")
    place = None if origin is None else numbers(origin.get("xyz", "0 0 0"), 3)
    return np.zeros(3) if place is None else place
