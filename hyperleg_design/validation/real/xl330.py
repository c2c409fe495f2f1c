"""Cases on the XL330 pendulum (BAM's recordings): one servo that swings a known mass."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.validation.benchmark.adapter import open_recordings
from hyperleg_design.validation.benchmark.case import (
    Case,
    Fault,
    Material,
    Recording,
    Truth,
    labelled,
)

FOLDER = "xl330_pendulum"
PLACES = ("servo", "arm")
MJCF = """<mujoco model="xl330_pendulum">
  <compiler angle="radian"/>
  <worldbody>
    <body name="stand" pos="0 0 0.5">
      <geom type="box" size="0.01 0.01 0.01" contype="0" conaffinity="0" mass="0"/>
      <body name="arm">
        <inertial pos="0 0 -0.05" mass="0.002" diaginertia="2e-6 2e-6 1e-7"/>
        <joint name="servo" axis="0 1 0"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="servo" joint="servo"/></actuator>
</mujoco>
"""
"""The mass hangs on the arm as a declared payload; friction and rotor are not published with the
logs."""
MASS_ERROR = 0.2
"""Of the declared mass [kg]."""
LOADS = (("link_mass", PLACES), ("link_com", PLACES))
FAULTS: dict[str, tuple[str, float, Fault | None]] = {
    "nothing": ("", 1.0, None),
    "gain_double": ("gain", 2.0, Fault("controller_gain", PLACES, {"stiffness_scale": 0.5})),
    "gain_half": ("gain", 0.5, Fault("controller_gain", PLACES, {"stiffness_scale": 2.0})),
    "constant_high": (
        "constant",
        1.25,
        Fault("torque_constant", PLACES, {"scale": 0.8}, (("transmission_ratio", PLACES),)),
    ),
    "mass_light": ("mass", -MASS_ERROR, Fault("payload", PLACES, {"mass": MASS_ERROR}, LOADS)),
    "mass_heavy": ("mass", MASS_ERROR, Fault("payload", PLACES, {"mass": -MASS_ERROR}, LOADS)),
}
"""What is declared wrongly, how much, and the truth that follows."""
PLAN = (
    ("nothing", "other"),
    ("nothing", "same"),
    ("nothing", "no"),
    ("gain_double", "other"),
    ("gain_half", "same"),
    ("constant_high", "same"),
    ("mass_light", "other"),
    ("mass_heavy", "same"),
)
"""Fault, and of which motion the references are."""
KINDS = ("sin_sin", "up_and_down")
"""Motions, of which each was recorded with the firmware's gain at 100, 200, 400 and 800."""
TESTED, SPARED = (100, 400), (200, 800)
"""Gains of the tests, and of the references where these repeat the tests' motion."""


def xl330_cases() -> list[Case]:
    """All cases; those of the first motion are for development."""
    return [
        Case(
            f"xl330-{fault}-{kind}-{references}",
            "real",
            "development" if kind == KINDS[0] else "held out",
            f"XL330 pendulum, {fault.replace('_', ' ')}, motion {kind}, references of "
            f"{references} motion",
            "nothing" if FAULTS[fault][2] is None else "single",
            partial(material, kind=kind, fault=fault, references=references),
            needs=FOLDER,
        )
        for kind in KINDS
        for fault, references in PLAN
    ]


def material(data: Path, kind: str, fault: str, references: str) -> tuple[Material, Truth]:
    """The files of one case and its truth.

    Args:
        data: folder of the real logs.
        kind: motion of the tests, of `KINDS`.
        fault: a key of `FAULTS`.
        references: of the `same` or the `other` motion, or `no`.

    Raises:
        InputError: there are no such recordings.
    """
    paths = sorted((data / FOLDER).glob("*.json"))
    if not paths:
        raise InputError(str(data / FOLDER), "", None, "holds no recordings of the XL330")
    contents = [json.loads(path.read_text()) for path in paths]
    hung = [float(contents[0]["mass"]), 0.0, 0.0, -float(contents[0]["length"])]
    by_motion: dict[tuple[str, int], Recording] = {}
    for path, content in zip(paths, contents, strict=True):
        (log,) = labelled(open_recordings(path), base="fixed", payload={"arm": hung})
        by_motion[str(content["trajectory"]), int(content["kp"])] = log
    gains = (*TESTED, *SPARED)
    other = next(k for k in KINDS if k != kind)
    chosen = {
        "same": [(kind, gain) for gain in SPARED],
        "other": [(other, gain) for gain in gains],
        "no": [],
    }[references]
    tested = [(kind, gain) for gain in (TESTED if references == "same" else gains)]
    what, size, truth = FAULTS[fault]
    files = Material(
        MJCF,
        tuple(_declared(by_motion[key], what, size, hung) for key in tested),
        tuple(by_motion[key] for key in chosen),
    )
    return files, Truth(() if truth is None else (truth,), references=bool(chosen))


def _declared(log: Recording, what: str, size: float, hung: list[float]) -> Recording:
    known: dict[str, Any] = dict(log.metadata)
    if what == "gain":
        return log.declared(gains={j: [k * size, d] for j, (k, d) in known["gains"].items()})
    if what == "constant":
        constants = {m: k * size for m, k in known["torque_constant"].items()}
        return log.declared(torque_constant=constants)
    if what == "mass":
        return log.declared(payload={"arm": [hung[0] + size, *hung[1:]]})
    return log
