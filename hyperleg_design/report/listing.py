"""What is shipped, for people and programs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.report.text import table
from hyperleg_design.robot.ablation import DESCRIPTION
from hyperleg_design.robot.kinematics.dimensions import total_mass
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.motors import catalogue
from hyperleg_design.robot.parameters.described import RobotDesign

KINDS = (
    "designs",
    "variants",
    "motors",
    "sweeps",
    "tasks",
    "protocols",
    "presets",
    "policies",
    "measures",
    "parameters",
)
_LONG = ("measures", "parameters")
"""Kinds that are shown only where they are asked for."""


def listing(kind: str = "all", design: str = "hyperleg") -> dict[str, Any]:
    """List everything that is shipped, by kind.

    Args:
        kind: one of `KINDS`, or `all`.
        design: whose parameters are listed: a shipped name or a YAML file.

    Returns:
        Entries by kind.

    Raises:
        InputError: no such kind.
    """
    if kind != "all" and kind not in KINDS:
        raise InputError("list", "", kind, f"expects one of all, {', '.join(KINDS)}")
    makers: dict[str, Callable[[], Any]] = {
        "designs": _designs,
        "variants": lambda: DESCRIPTION,
        "motors": _motors,
        "sweeps": _sweeps,
        "tasks": lambda: _of_sim("task"),
        "protocols": lambda: _of_sim("protocol"),
        "presets": lambda: _of_sim("preset"),
        "policies": _policies,
        "measures": _measures,
        "parameters": lambda: _parameters(load_robot(design)),
    }
    chosen = [k for k in KINDS if k not in _LONG] if kind == "all" else (kind,)
    return {k: makers[k]() for k in chosen}


def _designs() -> dict[str, Any]:
    designs = {}
    for name in resources.names("descriptions"):
        design = load_robot(name)
        designs[name] = {"variant": design.variant, "total_mass": float(total_mass(design))}
    return designs


def _motors() -> dict[str, Any]:
    return {
        m.name: {
            "vendor": m.vendor,
            "kind": m.kind,
            "mass": m.mass,
            "peak_torque": m.peak_torque("vendor"),
            "rated_torque": m.rated_torque,
            "no_load_speed": m.no_load_speed("vendor"),
            "corner_speed": m.corner_speed("vendor"),
            "stall_torque": m.stall_torque("vendor"),
            "power_constant": m.power_constant("vendor"),
            "motor_constant": m.motor_constant("vendor"),
            "rated_heat": m.rated_heat("vendor"),
            "presets": sorted(m.presets),
            "description": m.description,
        }
        for m in catalogue().values()
    }


def _sweeps() -> dict[str, Any]:
    from hyperleg_design.reading import read_yaml

    return {
        n: {"description": str(read_yaml(resources.find("sweeps", n)).get("description", ""))}
        for n in resources.names("sweeps")
    }


def _of_sim(what: str) -> dict[str, Any]:
    """Files `sim/WHAT_NAME.yaml`; each begins with a comment that says what it is."""
    entries = {}
    for name in resources.sim_names(what):
        comment = []
        for line in resources.find_sim(what, name).read_text(encoding="utf-8").splitlines():
            if not line.startswith("#"):
                break
            comment.append(line.lstrip("# "))
        entries[name] = {"description": " ".join(comment)}
    return entries


def _measures() -> dict[str, Any]:
    """What `analyze` and sweeps compute of a design, and what `evaluate` measures of its trials."""
    from hyperleg_design.sweep import registry

    return {
        name: {"unit": m.unit, "better": m.better, "description": m.doc}
        for name, m in registry.entries().items()
    }


def _policies() -> dict[str, Any]:
    from hyperleg_design.evaluation.shipped import shipped_policies

    policies: dict[str, Any] = {}
    for policy in shipped_policies():
        policies.setdefault(
            policy.training,
            {"group": policy.group, "design": policy.design, "seed": policy.seed, "files": []},
        )["files"].append(policy.path.name)
    return policies


def _parameters(design: RobotDesign) -> dict[str, Any]:
    rows = {}
    for path, rule in design.rules.items():
        value = design[path]
        origin = design.origins.get(path)
        rows[path] = {
            "value": value.tolist() if hasattr(value, "tolist") else value,
            "unit": rule.unit,
            "low": None if rule.low == float("-inf") else rule.low,
            "high": None if rule.high == float("inf") else rule.high,
            "label": origin.label if origin else "",
        }
    return rows


def listing_text(shipped: dict[str, Any], width: int | None = None) -> str:
    """Write a listing as tables for a terminal.

    Args:
        shipped: as `listing` returns it.
        width: of the terminal in characters, to which descriptions are wrapped; not by default.

    Returns:
        The text.
    """
    parts = []
    for kind, entries in shipped.items():
        parts.append(kind)
        if kind == "motors":
            columns = [
                "mass",
                "peak_torque",
                "rated_torque",
                "no_load_speed",
                "corner_speed",
                "motor_constant",
            ]
            heads = [
                "motor",
                "vendor",
                "kind",
                "mass [kg]",
                "peak [Nm]",
                "rated [Nm]",
                "no load [rad/s]",
                "corner [rad/s]",
                "Km [Nm/W^0.5]",
            ]
            parts.append(
                table(
                    heads,
                    [
                        [n, e["vendor"], e["kind"], *(e[c] for c in columns)]
                        for n, e in entries.items()
                    ],
                )
            )
        elif kind == "designs":
            parts.append(
                table(
                    ["design", "variant", "mass [kg]"],
                    [[n, e["variant"], e["total_mass"]] for n, e in entries.items()],
                )
            )
        elif kind == "policies":
            rows = [
                [n, e["group"], e["design"], str(e["seed"]), str(len(e["files"]) - 1)]
                for n, e in entries.items()
            ]
            parts.append(table(["policy", "task", "design", "seed", "late checkpoints"], rows))
        elif kind == "measures":
            rows = [[n, e["unit"], e["better"], e["description"]] for n, e in entries.items()]
            parts.append(table(["measure", "unit", "better", "what it is"], rows, width))
        elif kind == "parameters":
            rows = [
                [
                    n,
                    str(e["value"]),
                    e["unit"],
                    "" if e["low"] is None else f"{e['low']:g} .. {e['high']:g}",
                    e["label"],
                ]
                for n, e in entries.items()
            ]
            parts.append(table(["parameter", "value", "unit", "range", "label"], rows))
        else:
            parts.append(
                table(
                    [kind[:-1], "description"],
                    [
                        [n, e if isinstance(e, str) else e["description"]]
                        for n, e in entries.items()
                    ],
                    width,
                )
            )
        parts.append("")
    return "\n".join(parts).rstrip()
