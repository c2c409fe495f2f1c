"""Cases on the arm of a TIAGo (PAL Robotics): motor currents of four joints with harmonic drives.

The recording and the robot file come with the source distribution of `figaroh` 1.0.2 on PyPI,
`tests/fixtures/tiago`: `tiago_48_schunk.urdf` and `data/identification/tiago_*.csv` belong into the
folder `tiago` of the real logs. Reductions and torque constants are those of its examples. Which
hand the robot had is not said; of the file's four, a regression of the currents on the gravity of
this one has the slope 1.00 at joint 4 (0.90, 1.11 and 1.36 with the others). The file's friction
and damping of 1 Nm and 1 Nms/rad are placeholders: the same regression tells 2 to 6 Nm and 4 to 29
Nms/rad. Faults were drawn by a seed before any was diagnosed.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.validation.benchmark.case import (
    Case,
    Fault,
    Material,
    Recording,
    Truth,
    labelled,
)

FOLDER = "tiago"
ROBOT = "tiago_48_schunk.urdf"
JOINTS = ("torso_lift_joint", *(f"arm_{i}_joint" for i in range(1, 8)))
CONSTANTS = {1: 13.6, 2: 13.6, 3: -8.7, 4: -8.7}
"""Torque of an arm joint over its motor's current [Nm/A], by joint; the other joints log none."""
WINDOWS = (9.2, 20.9, 32.7, 44.4, 56.2, 67.9)
"""Times at which the moving part of the recording is cut into five logs [s]."""
TURNING = 0.01
"""Speed over which added Coulomb friction turns over [rad/s]."""
ALIKE = {
    4: ("arm_5_link",),
    7: ("arm_6_link", "wrist_ft_link", "wrist_ft_tool_link", "arm_tool_link", "gripper_link"),
}
"""Links at which a load leaves the same trace as at one of these, as no joint between them tells
its torque."""
HELD = 0.05
"""Distance of a declared load from the origin of its link, along its axis z [m]."""
DRAWN: tuple[tuple[str, int, float, int], ...] = (
    ("torque", 3, 1.4, 4),
    ("encoder", 4, -0.19, 0),
    ("coulomb", 3, 4.7, 1),
    ("viscous", 4, 28.0, 2),
    ("spring", 4, 8.8, 2),
    ("load", 7, 2.4, 3),
    ("torque", 4, 1.5, 1),
    ("encoder", 2, -0.11, 2),
    ("coulomb", 4, 4.3, 2),
    ("viscous", 1, 12.0, 4),
    ("spring", 4, 7.1, 1),
    ("load", 4, 2.7, 0),
    ("torque", 3, 0.76, 4),
    ("encoder", 2, 0.28, 1),
    ("coulomb", 2, 2.8, 2),
    ("viscous", 3, 14.0, 0),
    ("spring", 4, 6.1, 3),
    ("load", 7, 1.9, 0),
    ("torque", 3, 1.5, 0),
    ("encoder", 3, -0.2, 3),
    ("coulomb", 1, 2.7, 2),
    ("viscous", 3, 26.0, 2),
    ("spring", 4, 10.0, 2),
    ("load", 4, 2.3, 3),
)
"""What is wrong, at which joint or link of the arm, how much, and in which log. A motor gives that
multiple of its torque; friction and springs act in addition; a declared load is not there."""


def tiago_cases() -> list[Case]:
    """Five logs with nothing wrong, each beside the other four, and the drawn faults."""
    plan: list[tuple[str, int, float, int]] = [("nothing", 0, 0.0, w) for w in range(5)]
    return [
        Case(
            f"tiago-{number:02d}-{what}",
            "drawn",
            "development",
            f"TIAGo's arm, {what}{f' at {place}: {size:g}' if place else ''}, log {window}",
            "single" if place else "nothing",
            partial(material, what=what, place=place, size=size, window=window),
            needs=FOLDER,
        )
        for number, (what, place, size, window) in enumerate([*plan, *DRAWN])
    ]


def material(data: Path, what: str, place: int, size: float, window: int) -> tuple[Material, Truth]:
    """The files of one case and its truth.

    Args:
        data: folder of the real logs.
        what: `nothing`, or of `DRAWN`.
        place: number of the joint or link of the arm.
        size: how much.
        window: number of the log that is tested; the other four are references.
    """
    folder = data / FOLDER
    whole = _recording(folder)
    logs = [
        replace(whole.part(begin, end), name=f"part_{i}")
        for i, (begin, end) in enumerate(itertools.pairwise(WINDOWS))
    ]
    tested, fault = logs.pop(window), None
    if what != "nothing":
        change, effect, parameters, equivalents = CHANGES[what]
        tested = change(tested, place, size)
        joint, link = f"arm_{place}_joint", f"arm_{place}_link"
        places = (link, *ALIKE[place]) if what == "load" else (joint,)
        fault = Fault(
            effect,
            places,
            {name: sign * size for name, sign in parameters.items()},
            tuple((other, places) for other in equivalents),
        )
    files = Material(
        str(folder / ROBOT), labelled([tested], base="fixed"), labelled(logs, base="fixed")
    )
    faults = () if fault is None else (fault,)
    return files, Truth(faults, references=True, identified=False)


def _recording(folder: Path) -> Recording:
    """The whole recording, without the effort of joints that report none in amperes."""
    columns = {}
    for kind in ("position", "velocity", "effort"):
        path = folder / f"tiago_{kind}.csv"
        try:
            rows = np.loadtxt(path, delimiter=",", skiprows=1)
        except OSError as error:
            raise InputError(str(path), "", None, "no such file") from error
        columns[kind] = rows[:, 1:]
        time = rows[:, 0]
    signals = {}
    for i, joint in enumerate(JOINTS):
        signals[f"position/{joint}"] = columns["position"][:, i]
        signals[f"velocity/{joint}"] = columns["velocity"][:, i]
        if i in CONSTANTS:
            signals[f"motor_current/{joint}"] = np.sign(CONSTANTS[i]) * columns["effort"][:, i]
    constants = {JOINTS[i]: abs(constant) for i, constant in CONSTANTS.items()}
    return Recording("tiago", time, signals, {"torque_constant": constants})


def _weak(log: Recording, place: int, size: float) -> Recording:
    constants = dict(log.metadata["torque_constant"])
    constants[JOINTS[place]] /= size
    return log.declared(torque_constant=constants)


def _turned(log: Recording, place: int, size: float) -> Recording:
    return log.shifted(size, f"position/{JOINTS[place]}")


def _loaded(log: Recording, place: int, size: float) -> Recording:
    return log.declared(payload={f"arm_{place}_link": [size, 0.0, 0.0, HELD]})


def _resisting(
    torque: Callable[[Recording, str], np.ndarray],
) -> Callable[[Recording, int, float], Recording]:
    """Change of a log in which a joint's motor also overcomes a torque [Nm] over its size."""

    def changed(log: Recording, place: int, size: float) -> Recording:
        joint = JOINTS[place]
        column = f"motor_current/{joint}"
        more = size * torque(log, joint) / log.metadata["torque_constant"][joint]
        return replace(log, signals={**log.signals, column: log.signals[column] + more})

    return changed


def _sign(log: Recording, joint: str) -> np.ndarray:
    return np.asarray(np.tanh(log.signals[f"velocity/{joint}"] / TURNING))


def _speed(log: Recording, joint: str) -> np.ndarray:
    return log.signals[f"velocity/{joint}"]


def _stretch(log: Recording, joint: str) -> np.ndarray:
    position = log.signals[f"position/{joint}"]
    return np.asarray(position - position.mean())


CHANGES: dict[
    str,
    tuple[Callable[[Recording, int, float], Recording], str, dict[str, float], tuple[str, ...]],
] = {
    "torque": (_weak, "torque_constant", {"scale": 1.0}, ("transmission_ratio",)),
    "encoder": (_turned, "encoder_offset", {"offset": 1.0}, ()),
    "coulomb": (_resisting(_sign), "coulomb_friction", {"torque": 1.0}, ("stribeck_friction",)),
    "viscous": (_resisting(_speed), "viscous_friction", {"damping": 1.0}, ()),
    "spring": (_resisting(_stretch), "joint_spring", {"stiffness": 1.0}, ()),
    "load": (_loaded, "payload", {"mass": -1.0}, ("link_mass", "link_com")),
}
"""How a log is changed, the effect that this is, the signs of its parameters over the size, and
other effects that these logs cannot tell from it."""
