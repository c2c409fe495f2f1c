"""Units at joints that slide: effects, residuals and logs state theirs for joints that turn."""

from __future__ import annotations

from hyperleg_design.gap.model.subject import Subject

SLIDING = {
    "rad": "m",
    "rad/s": "m/s",
    "1/rad": "1/m",
    "Nm": "N",
    "1/Nm": "1/N",
    "rad/Nm": "m/N",
    "Nm/rad": "N/m",
    "Nms/rad": "Ns/m",
    "kg m^2": "kg",
}
"""By the unit at a joint that turns."""


def joint_unit(unit: str, slides: bool) -> str:
    """State a unit at a joint.

    Args:
        unit: at a joint that turns.
        slides: whether this one slides.

    Returns:
        The unit; that which was given where both kinds of joints have the same.
    """
    return SLIDING.get(unit, unit) if slides else unit


def slides(subject: Subject, kind: str, location: str) -> bool:
    """Tell whether what sits at a place goes along a line, not around an axis.

    Args:
        subject: the robot.
        kind: of the place: `joint`, `motor`, `link`, `foot`, `sensor` or `robot`.
        location: its name.

    Returns:
        True of a joint that slides, and of a motor that moves no joint that turns.
    """
    if kind == "joint" and location in subject.joints:
        return not subject.tree.hinge[subject.joints.index(location)]
    if kind == "motor" and location in subject.motors:
        moved = subject.joint_from_motor[:, subject.motors.index(location)] != 0
        return bool(moved.any() and not subject.tree.hinge[moved].any())
    return False


def unit_at(subject: Subject, kind: str, location: str, unit: str) -> str:
    """State a unit at a place of a robot.

    Args:
        subject: the robot.
        kind: of the place: `joint`, `motor`, `link`, `foot`, `sensor` or `robot`.
        location: its name.
        unit: that it has where joints turn.

    Returns:
        The unit there.
    """
    return joint_unit(unit, slides(subject, kind, location))
