"""Whether what a log declares in its metadata names fields, joints and motors that there are."""

from __future__ import annotations

import difflib
from collections.abc import Collection

import numpy as np

from hyperleg_design.errors import meant
from hyperleg_design.gap.effects.drives.voltage_sag import SAGGING, voltage_spread
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import FIELDS, Metadata
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.results.finding import ERROR, WARNING, Finding


def declarations(metadata: Metadata, subject: Subject | None) -> list[Finding]:
    """Find declarations that would be ignored or refused later.

    Args:
        metadata: of the log.
        subject: the robot, if known.

    Returns:
        Warnings of unknown fields that are nearly known ones, and errors of joints and motors that
        the robot does not have.
    """
    findings = []
    for key in metadata.extra:
        if near := difflib.get_close_matches(key, FIELDS, 1, cutoff=0.75):
            text = f"metadata have a field {key} that nothing reads"
            findings.append(Finding(WARNING, "", text, f"did you mean {near[0]}?"))
    if subject is None:
        return findings
    joints = {*subject.joints, *subject.unlogged}
    motors = {*subject.motors, *subject.motor_aliases, *subject.unlogged}
    for field, names, known in (
        ("gains", metadata.gains, joints),
        ("torque_constant", metadata.torque_constant, motors),
        ("supply", metadata.supply, motors),
    ):
        findings += [_stranger(field, name, known) for name in names if name not in known]
    return findings


def undeclared_supply(log: Log) -> list[Finding]:
    """Find a battery that sags under servos of which nobody knows whether they have a current loop.

    Args:
        log: the log.

    Returns:
        A warning where the voltage varies, no torque or current is measured, and no supply is
        declared.
    """
    voltage = log.column("battery_voltage")
    measured = any(
        log.has(kind, m) for kind in ("motor_torque", "motor_current") for m in log.motors
    )
    if log.metadata.supply or measured or not np.isfinite(voltage).any():
        return []
    spread = voltage_spread(voltage)
    if spread < SAGGING:
        return []
    text = f"varies by {100 * spread:.0f} %, and no supply is declared"
    remedy = (
        "declare supply {motor: [nominal V, stall Nm, no-load rad/s]} of servos without a current "
        "loop; without it, torques that follow the battery look like wrong gains"
    )
    return [Finding(WARNING, "battery_voltage", text, remedy)]


def _stranger(field: str, name: str, known: Collection[str]) -> Finding:
    text = f"metadata declare {field} of {name}, which the robot lacks"
    return Finding(ERROR, "", text, meant(name, sorted(known)))
