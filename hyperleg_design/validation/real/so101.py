"""Cases on the SO-101 arm (SAGE's recordings), all held out: six servos, targets and positions."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from hyperleg_design.sizing.other_robots import robots_folder
from hyperleg_design.validation.benchmark.adapter import open_recordings
from hyperleg_design.validation.benchmark.case import (
    Case,
    Fault,
    Material,
    Recording,
    Truth,
    labelled,
)

FOLDER = "so101_arm"
JOINTS = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper")
"""In the description, in the order of the logs."""
HAND = ("gripper_link", "wrist_roll", "moving_jaw_so101_v1_link", "gripper")
WRONG: dict[str, tuple[str, float, Fault | None]] = {
    "nothing": ("", 1.0, None),
    "gain_double_shoulder_lift": (
        "shoulder_lift",
        2.0,
        Fault("controller_gain", ("shoulder_lift",), {"stiffness_scale": 0.5}),
    ),
    "gain_half_elbow_flex": (
        "elbow_flex",
        0.5,
        Fault("controller_gain", ("elbow_flex",), {"stiffness_scale": 2.0}),
    ),
    "load_declared": ("load", 0.3, Fault("payload", HAND, {"mass": -0.3}, (("link_mass", HAND),))),
}
"""What is declared wrongly, how much, and the truth that follows."""
TESTS, REFERENCES = ("step_response", "triangle_wave"), ("chirp_sweep", "friction_gravity")


def so101_cases() -> list[Case]:
    """List all cases of these robots."""
    plan = [(fault, True) for fault in WRONG] + [("nothing", False)]
    return [
        Case(
            f"so101-{fault}-{'referenced' if referenced else 'alone'}",
            "real",
            "held out",
            f"SO-101 arm, {fault.replace('_', ' ')}, steps and triangles, "
            f"{'chirp and slow motions as references' if referenced else 'no references'}",
            "nothing" if WRONG[fault][2] is None else "single",
            partial(material, fault=fault, referenced=referenced),
            needs=FOLDER,
        )
        for fault, referenced in plan
    ]


def material(data: Path, fault: str, referenced: bool) -> tuple[Material, Truth]:
    """The files of one case and its truth.

    Args:
        data: folder of the real logs.
        fault: a key of `WRONG`.
        referenced: whether reference logs go along.
    """
    robot = str(robots_folder() / "so_arm_description" / "urdf" / "so101.urdf")

    def read(name: str) -> tuple[Recording, ...]:
        logs = open_recordings(data / FOLDER / name, {"joints": list(JOINTS)})
        return labelled(logs, base="fixed")

    what, size, truth = WRONG[fault]
    tests = tuple(_declared(log, what, size) for name in TESTS for log in read(name))
    references = tuple(log for name in REFERENCES if referenced for log in read(name))
    return (
        Material(robot, tests, references),
        Truth(() if truth is None else (truth,), references=referenced, identified=False),
    )


def _declared(log: Recording, what: str, size: float) -> Recording:
    if what == "load":
        return log.declared(payload={"gripper_link": [size, 0.0, 0.0, -0.05]})
    if not what:
        return log
    gains = {
        joint: [k * (size if joint == what else 1.0), d]
        for joint, (k, d) in log.metadata["gains"].items()
    }
    return log.declared(gains=gains)
