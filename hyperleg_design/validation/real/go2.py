"""Cases on the Go2 that hangs in the air (PACE's recording), all held out: positions and targets.

The nominal gains are soft, so the joints lag their targets by 90 to 115 ms without any delay.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from hyperleg_design.sizing.other_robots import robots_folder
from hyperleg_design.validation.benchmark.adapter import open_recordings
from hyperleg_design.validation.benchmark.case import Case, Fault, Material, Truth

FOLDER = "go2_air"
JOINTS = tuple(
    f"{leg}_{part}_joint" for leg in ("FL", "FR", "RL", "RR") for part in ("hip", "thigh", "calf")
)
GAINS = [20.0, 1.5]
"""Nominal stiffness [Nm/rad] and damping [Nms/rad]."""
HALF = 11.5
"""The first part of the recording is the reference of the second [s]."""
WRONG: dict[str, tuple[str, float]] = {
    "nothing": ("", 1.0),
    "gain_double_thigh": ("FL_thigh_joint", 2.0),
    "gain_half_calf": ("RR_calf_joint", 0.5),
}
"""Joint whose gain is declared wrongly, and the factor."""


def go2_cases() -> list[Case]:
    """List all cases of these robots."""
    plan = [("nothing", False), *((fault, True) for fault in WRONG)]
    return [
        Case(
            f"go2-{fault}-{'referenced' if referenced else 'alone'}",
            "real",
            "held out",
            f"Go2 in the air, {fault.replace('_', ' ')}, "
            f"{'first half as reference' if referenced else 'no references'}",
            "nothing" if fault == "nothing" else "single",
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
        referenced: whether the first half goes along as a reference, or is part of the test.
    """
    robot = str(robots_folder() / "go2_description" / "urdf" / "go2.urdf")
    (log,) = open_recordings(data / FOLDER / "traj_0.pt", {"joints": list(JOINTS)})
    log = log.declared(base="fixed", gains=dict.fromkeys(JOINTS, GAINS))
    joint, factor = WRONG[fault]
    stiffness = {name: [GAINS[0] * (factor if name == joint else 1), GAINS[1]] for name in JOINTS}
    test = log.part(HALF, float("inf")) if referenced else log
    references = (log.part(0.0, HALF),) if referenced else ()
    wrong = Fault("controller_gain", (joint,), {"stiffness_scale": 1 / factor}) if joint else None
    return (
        Material(robot, (test.declared(gains=stiffness),), references),
        Truth(() if wrong is None else (wrong,), references=referenced, identified=False),
    )
