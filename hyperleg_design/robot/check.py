"""Checking the files that describe robots: designs, motors, URDF and MJCF, each by its own
rules.
"""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design import resources
from hyperleg_design.errors import InputError, shown
from hyperleg_design.reading import read_yaml
from hyperleg_design.robot.checks.check_housing import check_housing
from hyperleg_design.robot.checks.check_mjcf import check_mjcf
from hyperleg_design.robot.checks.check_motor import check_motor
from hyperleg_design.robot.checks.check_pads import check_pads
from hyperleg_design.robot.checks.check_urdf import check_urdf
from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.checks.urdf_xml import parse_xml
from hyperleg_design.robot.design import Design
from hyperleg_design.robot.linkage import LinkageModel
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.motors import Motor, catalogue, load_motor
from hyperleg_design.robot.trees.rod_range import RodRange, rod_ranges
from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign

KINDS = ("design", "motor", "urdf", "mjcf")
XML = (".urdf", ".xml", ".mjcf")


def kind_of(path: str | Path) -> str:
    """Find out what a file holds.

    Args:
        path: of the file; a bare name is a shipped design.

    Returns:
        One of `KINDS`, or `unknown`.

    Raises:
        InputError: there is no such file, or it cannot be read or parsed.
    """
    if Path(path).suffix.lower() in XML:
        root, _ = parse_xml(path)
        tag = None if root is None else root.tag
        if tag not in ("robot", "mujoco"):
            return (
                "urdf"
                if Path(path).suffix.lower() == ".urdf"
                else "mjcf"
                if root is None
                else "unknown"
            )
        return "urdf" if tag == "robot" else "mjcf"
    if Path(path).suffix.lower() not in ("", ".yaml", ".yml"):
        return "unknown"
    data = read_yaml(resources.find("descriptions", path))
    if "constants" in data and "convention" in data:
        return "motor"
    return "design" if {"base", "pelvis", "family"} & set(data) else "unknown"


def check_file(path: str | Path) -> list[Finding]:
    """Everything wrong with a design, motor, URDF or MJCF file.

    Args:
        path: a file, or the name of a shipped design.

    Returns:
        Findings, errors first; empty where nothing is wrong.

    Raises:
        InputError: there is no such file, or it cannot be read.
    """
    if Path(path).suffix.lower() in XML:
        parse_xml(path)  # whether it can be read
    else:
        path = resources.find("descriptions", path)
    try:
        kind = kind_of(path)
        if kind == "motor":
            motor = load_motor(Path(path))
            return [*check_motor(motor), *_unreachable(motor, Path(path))]
        if kind == "design":
            return _check_design_file(path)
    except InputError as error:
        return [finding_of(error)]
    if kind == "urdf":
        return check_urdf(Path(path))
    if kind == "mjcf":
        return check_mjcf(Path(path))
    return [
        Finding(
            "error",
            str(path),
            "is of no kind that can be checked",
            "expects a design (a YAML file with family: or base:), a motor (with constants: and "
            "convention:), a sweep (with axes:), a URDF, or an MJCF file",
        )
    ]


def _unreachable(motor: Motor, path: Path) -> list[Finding]:
    """A warning of a good motor file that designs cannot name as things stand."""
    known = catalogue().get(motor.name)
    if known == motor:
        return []
    folder = path.parent
    return [
        Finding(
            "warning",
            str(path),
            f"can be used, but {motor.name} "
            + ("names another motor of the catalogue" if known else "is not in the catalogue"),
            f"use its path as the motor, or --motors {folder}"
            + (" under another name" if known else ""),
        )
    ]


def finding_of(error: InputError, severity: str = "error") -> Finding:
    """Turn an input error into a finding.

    Args:
        error: the error.
        severity: `error` or `warning`.

    Returns:
        The finding, with the place, the value and the remedy of the error.
    """
    if error.value is None:
        return Finding(severity, error.place, error.remedy)
    return Finding(severity, error.place, f"is {shown(error.value)}", error.remedy)


def _check_design_file(path: str | Path) -> list[Finding]:
    """A design that loads must also become a URDF without faults; one without a linkage model gets
    a warning.
    """
    from hyperleg_design.robot.description import urdf

    design = load_robot(path)
    findings = [
        dataclasses.replace(finding, place=re.sub(r" \(line \d+\)$", "", finding.place))
        for finding in check_urdf(urdf(design))  # lines of a text that the user does not see
    ]
    findings += _narrow_ranges(design)
    if isinstance(design, TreeDesign):
        findings += [f for rod in rod_ranges(design) for f in _rod_findings(rod)]
        findings += [*check_housing(design), *check_pads(design)]
    try:
        if isinstance(design, Design):
            LinkageModel.of(design)
    except InputError as error:
        findings.append(finding_of(error, "warning"))
    return findings


def _narrow_ranges(design: RobotDesign) -> list[Finding]:
    """A warning where no joint moves by more degrees than a whole turn has radians."""
    widths = {n: float(j.upper_deg - j.lower_deg) for n, j in design.joint_sections.items()}
    if any(width > 2 * np.pi for width in widths.values()):
        return []
    widest = max(widths, key=lambda name: widths[name])
    message = f"no range of motion is wider than {widths[widest]:g} deg, that of {widest}"
    remedy = "lower_deg, upper_deg and default_deg are degrees; 1 rad is 57.3 deg"
    return [Finding("warning", "joints", message, remedy)]


def _rod_findings(rod: RodRange) -> list[Finding]:
    """Warnings of a linkage that cannot follow its joints over their whole ranges."""
    place, remedy = f"rods.{rod.motor}", "move its points, or narrow the ranges of the joints"
    findings = []
    if rod.beyond:
        message = f"does not reach at {_posture(rod.beyond)}"
        findings.append(Finding("warning", place, message, remedy))
    for joint, posture in rod.reversed.items():
        message = f"has passed a dead centre at {_posture(posture)}, where it turns {joint} back"
        findings.append(Finding("warning", place, message, remedy))
    return findings


def _posture(angles: dict[str, float]) -> str:
    return ", ".join(f"{joint} {angle:g} deg" for joint, angle in angles.items())


__all__ = ["KINDS", "Finding", "check_file", "check_mjcf", "check_urdf", "finding_of", "kind_of"]
