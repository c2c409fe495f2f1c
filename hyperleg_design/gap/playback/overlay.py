"""Overlays: effects that a diagnosis found, to be added to the simulation, as a YAML file.

    schema: 1
    robot: hyperleg
    effects:
      - {effect: coulomb_friction, location: left_knee, parameters: {torque: 1.9}}
    source: {diagnosis: results/gap/diagnosis.json, verdict: explained, closed: 0.93}

Parameters that are not given stay at their nulls. `source` says where the effects come from;
nothing depends on it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.effect import Change
from hyperleg_design.gap.model.design_subject import subject_of
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.reading import given_path, read_json, read_yaml
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.robot.parameters.values import unknown
from hyperleg_design.simulation.alteration import Alteration
from hyperleg_design.writing import write_text

SCHEMA = 1
_KEYS = ("schema", "robot", "effects", "source")
_EFFECT_KEYS = ("effect", "location", "parameters")


@dataclass(frozen=True)
class Overlay:
    """Effects to add to a robot's simulation, and where they come from."""

    robot: str
    """Name of the robot that they were found on."""
    change: Change
    """Values of parameters by (effect, location); those that are missing are at their nulls."""
    source: Mapping[str, Any] = field(default_factory=dict)
    """Of the effects: plain values, for people."""

    def __post_init__(self) -> None:
        where = self.robot or "overlay"
        checked = {
            (effect, place): _checked(where, f"{effect} at {place}", effect, values)
            for (effect, place), values in self.change.items()
        }
        object.__setattr__(self, "change", checked)

    def alterations(self, robot: Subject | RobotDesign) -> tuple[Alteration, ...]:
        """Make the alterations that add the effects to a simulation of a robot.

        Args:
            robot: a subject, or a design of ours.

        Returns:
            The alterations.

        Raises:
            InputError: the robot has no such place.
        """
        subject = robot if isinstance(robot, Subject) else subject_of(robot)
        return alterations(self.change, subject)

    def mapping(self) -> dict[str, Any]:
        """Write the overlay as its file has it.

        Returns:
            Nested mappings.
        """
        effects = [
            {"effect": e, "location": place, "parameters": dict(values)}
            for (e, place), values in self.change.items()
        ]
        own = {"robot": self.robot, "effects": effects, "source": dict(self.source)}
        return {"schema": SCHEMA, **own}


def alterations(change: Change, subject: Subject) -> tuple[Alteration, ...]:
    """Make the alterations that add effects to a simulation of a subject.

    Args:
        change: parameters by effect and location.
        subject: the robot.

    Returns:
        The alterations, in the order of the change.

    Raises:
        InputError: no such effect, or no such place on this robot.
    """
    added = []
    for (identifier, location), values in change.items():
        changed_effect = effect(identifier)
        numbers = np.array([values.get(p.name, p.null) for p in changed_effect.parameters], float)
        added.append(
            changed_effect.alteration(changed_effect.place(location, subject), numbers, subject)
        )
    return tuple(added)


def read_overlay(path: str | Path) -> Overlay:
    """Read the file of an overlay.

    Args:
        path: of the file.

    Returns:
        The validated overlay.

    Raises:
        InputError: it cannot be read, or something in it is wrong.
    """
    path = Path(path)
    return overlay_from_mapping(read_yaml(path), given_path(path))


def overlay_from_mapping(content: Mapping[str, Any], where: str) -> Overlay:
    """Build an overlay from what its file holds.

    Args:
        content: fields by name.
        where: file, for error messages.

    Returns:
        The validated overlay.

    Raises:
        InputError: something in it is wrong.
    """
    _only(content, _KEYS, where, "")
    if content.get("schema") != SCHEMA:
        remedy = f"expects {SCHEMA}; another version of hyperleg wrote this file"
        raise InputError(where, "schema", content.get("schema"), remedy)
    entries = content.get("effects")
    source = content.get("source") or {}
    robot = content.get("robot", "")
    if not isinstance(entries, list):
        raise InputError(where, "effects", entries, "expects a list of effects")
    if not isinstance(source, dict):
        raise InputError(where, "source", source, "expects a mapping")
    if not isinstance(robot, str):
        raise InputError(where, "robot", robot, "expects a name")
    change: dict[tuple[str, str], Mapping[str, float]] = {}
    for number, entry in enumerate(entries):
        place = f"effects.{number}"
        if not isinstance(entry, dict):
            raise InputError(where, place, entry, "expects effect, location and parameters")
        _only(entry, _EFFECT_KEYS, where, place)
        for name in ("effect", "location"):
            if not isinstance(entry.get(name), str):
                raise InputError(where, f"{place}.{name}", entry.get(name), "expects a name")
        key = entry["effect"], entry["location"]
        if key in change:
            raise InputError(where, place, f"{key[0]} at {key[1]}", "stands twice")
        change[key] = _checked(where, place, key[0], entry.get("parameters") or {})
    return Overlay(robot, change, source)


def write_overlay(path: str | Path, overlay: Overlay) -> Path:
    """Write the file of an overlay, whole or not at all; numbers keep all their digits.

    Args:
        path: of the file.
        overlay: the overlay.

    Returns:
        The path.
    """
    return write_text(path, yaml.safe_dump(overlay.mapping(), sort_keys=False, allow_unicode=True))


def overlay_of_diagnosis(path: str | Path, robot: str = "") -> Overlay:
    """Make an overlay of all causes that a `diagnosis.json` names.

    Args:
        path: of the file, or of the folder that holds it.
        robot: name to write down; that of the diagnosis by default.

    Returns:
        The overlay.

    Raises:
        InputError: it cannot be read, or names no cause.
    """
    path = Path(path)
    path = path / "diagnosis.json" if path.is_dir() else path
    where = given_path(path)
    content = read_json(path)
    diagnosis = content if isinstance(content, dict) else {}
    if diagnosis.get("schema") != 1 or not isinstance(diagnosis.get("causes"), list):
        remedy = "is not a diagnosis: expects schema 1 and a list of causes"
        raise InputError(where, "", None, remedy)
    verdict = content.get("verdict")
    if not content["causes"]:
        raise InputError(where, "causes", [], f"there is nothing to add: the verdict is {verdict}")
    change: dict[tuple[str, str], Mapping[str, float]] = {}
    for number, cause in enumerate(content["causes"]):
        try:
            key = cause["effect"], cause["location"]
            # the others are for readers, such as a limit beside its inverse
            own = {p.name for p in effect(str(key[0])).parameters}
            values = {
                name: value["value"] for name, value in cause["parameters"].items() if name in own
            }
        except (TypeError, KeyError, AttributeError):
            remedy = "expects effect, location and parameters, each with a value"
            raise InputError(where, f"causes.{number}", cause, remedy) from None
        if not values:
            remedy = f"none is a parameter of {key[0]}: {', '.join(own)}"
            raise InputError(
                where, f"causes.{number}.parameters", sorted(cause["parameters"]), remedy
            )
        change[key] = _checked(where, f"causes.{number}", key[0], values)
    gap = content.get("gap")
    closed = gap.get("closed") if isinstance(gap, dict) else None
    source = {"diagnosis": str(path), "verdict": verdict, "closed": closed}
    made_by = content.get("provenance")
    named = made_by.get("robot", "") if isinstance(made_by, dict) else ""
    return Overlay(robot or str(named), change, source)


def _only(content: Mapping[str, Any], known: tuple[str, ...], where: str, place: str) -> None:
    for key in content:
        if key not in known:
            field = f"{place}.{key}".lstrip(".")
            raise InputError(where, field, None, unknown(str(key), list(known)))


def _checked(where: str, place: str, identifier: Any, values: Any) -> dict[str, float]:
    """Values of one effect's parameters, after each was checked against its bounds."""
    changed_effect = effect(str(identifier))
    if not isinstance(values, Mapping):
        raise InputError(where, f"{place}.parameters", values, "expects a mapping of numbers")
    known = {p.name: p for p in changed_effect.parameters}
    _only(values, tuple(known), where, f"{place}.parameters")
    checked = {}
    for name, value in values.items():
        at = f"{place}.parameters.{name}"
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float | np.floating | np.integer)
            or not math.isfinite(value)
        ):
            raise InputError(where, at, value, "expects a finite number")
        checked[name] = known[name].checked(float(value), where, at)
    return checked
