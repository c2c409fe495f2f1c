"""Our numbers beside the paper's, a verdict each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import paper
from hyperleg_design.report.text import table
from hyperleg_design.robot import transmission
from hyperleg_design.robot.checks.consistency import leg_length
from hyperleg_design.robot.masses import mass_table
from hyperleg_design.robot.motors import find_motor
from hyperleg_design.robot.names import JOINTS
from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.parameters.described import RobotDesign

AGREES = 1e-3
"""Relative difference up to which a number agrees: what rounding to three or four digits leaves."""


WALK_MEASURES = (
    "cost_of_transport",
    "cost_of_transport_battery",
    "motor_side",
    "joule",
    "mechanical",
    "beyond_share",
    "margin_over_peak",
)
"""What `compare` shows of the planned walk's demand."""


@dataclass(frozen=True)
class Row:
    """One number of the paper beside ours."""

    place: str
    """Table or section."""
    quantity: str
    unit: str
    paper: float
    ours: float
    note: str = ""
    """Why they differ, where they do."""

    @property
    def difference(self) -> float:
        """Relative, ours over the paper's minus 1 [-]."""
        return self.ours / self.paper - 1

    @property
    def verdict(self) -> str:
        """`agrees` within rounding, else `differs`."""
        return "agrees" if abs(self.difference) <= AGREES else "differs"


def table_one(design: Design) -> list[Row]:
    """Recompute Table I and Section II.A of the paper from a design with an active toe.

    Args:
        design: one robot.

    Returns:
        One row for each printed number.
    """
    masses = mass_table(design)
    rows = [
        Row("Table I", "total mass", "kg", paper.TOTAL_MASS, float(masses.total)),
        Row("Section II.A", "leg mass", "kg", paper.LEG_MASS, float(masses.leg)),
        Row("Section II.A", "leg length", "m", paper.LEG_LENGTH, float(leg_length(design))),
        Row(
            "Section II.A",
            "height",
            "m",
            paper.HEIGHT,
            float(leg_length(design) + design.pelvis.height),
        ),
    ]
    standing = transmission.joint_from_motor(design, "standing")
    torque = transmission.max_joint_torque(design)
    speed = transmission.single_joint_speed(design, "standing")
    for index, joint in enumerate(transmission.joint_names(design)):
        ratio = (
            float(abs(standing[index]).max())
            if joint != "ankle_pitch"
            else float(standing[index][4])
        )
        rows.append(
            Row("Table I", f"{joint} reduction, standing", "", paper.REDUCTION[joint], ratio)
        )
        rows.append(
            Row(
                "Table I",
                f"{joint} torque, derated",
                "Nm",
                paper.MAX_JOINT_TORQUE[joint],
                float(torque[index]),
            )
        )
    for index, joint in enumerate(JOINTS[: len(speed)]):
        note = "the paper's is the motor's speed; ours is the joint's, the others standing still"
        rows.append(
            Row(
                "Table I",
                f"{joint} speed",
                "rad/s",
                paper.PRINTED_JOINT_SPEED[joint],
                float(speed[index]),
                note,
            )
        )
    return rows


def motor_rows(names: tuple[str, ...] = ("U10", "RI70", "RI60")) -> list[Row]:
    """Compare the paper's power constants with those that follow from the catalogue's resistance
    and torque constant.

    Args:
        names: of the motors.

    Returns:
        One row for each motor.
    """
    rows = []
    for name in names:
        motor = find_motor(name)
        note = (
            "the paper's Kt is near the back-EMF constant, not the vendor's Kt"
            if name.startswith("RI")
            else "catalogue R is derived from the paper's Cp"
        )
        rows.append(
            Row(
                "Table I",
                f"{name} Cp",
                "W/Nm²",
                motor.power_constant("paper"),
                motor.power_constant("vendor"),
                note,
            )
        )
        rows.append(
            Row(
                "Table I",
                f"{name} no-load speed",
                "rad/s",
                motor.no_load_speed("paper"),
                motor.no_load_speed("vendor"),
                "vendor's at nominal voltage",
            )
        )
    return rows


def compare(designs: Sequence[RobotDesign], *, demand: bool = False) -> dict[str, Any]:
    """Compute the same measures for several designs, to be compared side by side.

    Args:
        designs: at least one, each a single robot.
        demand: add what the planned walk asks of each.

    Returns:
        By design name: mass, reach and torque measures, SI units.
    """
    from hyperleg_design.sizing.analysis import analyze
    from hyperleg_design.sizing.demand import demand as demand_of
    from hyperleg_design.sizing.inertia import leg_inertia

    measures: dict[str, Any] = {}
    for design in designs:
        whole = analyze(design)
        if isinstance(design, TreeDesign):
            measures[_free(design.name, measures)] = _tree_entry(design, whole, demand)
            continue
        design = cast("Design", design)
        copied = (
            "variant",
            "total_mass",
            "leg_mass",
            "leg_length",
            "height",
            "max_joint_torque",
            "single_joint_speed",
            "torque_alone",
        )
        entry = {k: whole[k] for k in (*copied, "zonotope_to_box_volume")}
        inertia = leg_inertia(design)
        entry |= {
            k: float(getattr(inertia, k))
            for k in ("distal_share", "swing_inertia", "gyration_over_length")
        }
        if demand:
            walk = demand_of(design, "walk").summary()
            entry["walk"] = {k: walk[k] for k in WALK_MEASURES}
        measures[_free(design.name, measures)] = entry
    return measures


def _free(name: str, taken: Mapping[str, Any]) -> str:
    """A name that no earlier design of the comparison has."""
    return name if name not in taken else f"{name} ({len(taken) + 1})"


def _tree_entry(design: TreeDesign, whole: Mapping[str, Any], demand: bool) -> dict[str, Any]:
    """Measures of a design that writes its tree out, under HyperLeg's names where they mean the
    same.
    """
    if demand:
        raise InputError(
            "compare",
            "demand",
            design.name,
            "has no planned walk, which needs HyperLeg's legs; leave --demand out",
        )
    same = ("total_mass", "max_joint_torque", "single_joint_speed", "torque_alone")
    forces = whole["contact_force"]
    return {
        **{k: whole[k] for k in (*same, "zonotope_to_box_volume")},
        "leg_mass": whole["limb_mass"] if whole["limbs"] else "",
        "standing_height": "" if whole["standing_height"] is None else whole["standing_height"],
        "contact_force": {
            k: v["force"] if v["force"] is not None else "" for k, v in forces.items()
        },
    }


MEASURED = {
    "walk": (
        "cost_of_transport",
        "grf_peak_body_weights",
        "continuous_use",
        "limit_share",
        "mean_speed",
        "fell",
    ),
    "t_test": (
        "time",
        "mean_deviation",
        "cost_of_transport",
        "grf_peak_body_weights",
        "continuous_use",
        "fell",
    ),
}
"""What `compare` shows of evaluated trials, by protocol."""


def compare_walks(
    designs: Sequence[RobotDesign],
    protocols: Sequence[str],
    *,
    seeds: int = 3,
    policies: Sequence[str | Path] = (),
    workers: int = 2,
    swap: str = "",
) -> dict[str, dict[str, Any]]:
    """What trained policies do on each design; `policies_for` says which.

    Args:
        designs: each a single robot.
        protocols: `walk`, `t_test`.
        seeds: trainings of each in each folder.
        policies: folders of trainings; the shipped ones by default.
        workers: processes side by side.
        swap: one of `SWAPS`, of all designs; none by default.

    Returns:
        By protocol, in the order of `designs`: `policy` (whether it was trained for the design) and
        the measures of `MEASURED`, each with mean, low and high.
    """
    from hyperleg_design.evaluation.evaluate import evaluate_many
    from hyperleg_design.evaluation.policy_choice import policies_for
    from hyperleg_design.evaluation.result import swapped
    from hyperleg_design.report.evaluation_text import evaluation_rows
    from hyperleg_design.simulation.toe_swap import Swap

    by_protocol: dict[str, Any] = {}
    for protocol in protocols:
        jobs = [
            (i, design, policy.path)
            for i, design in enumerate(designs)
            for policy in policies_for(protocol, design, seeds, policies)
        ]
        done = evaluate_many(
            [path for _, _, path in jobs],
            protocol,
            designs=[design for _, design, _ in jobs],
            workers=workers,
            kept=0,
            alterations=Swap(swap) if swap else None,
        )
        done = [swapped(policy, swap) for policy in done] if swap else done
        by_protocol[protocol] = []
        for i in range(len(designs)):
            own = [e for e, (j, _, _) in zip(done, jobs, strict=True) if j == i]
            rows = {row["measure"]: row for row in evaluation_rows(own)}
            by_protocol[protocol].append(
                {"policy": own[0].trained.text()}
                | {
                    name: {k: rows[name][k] for k in ("mean", "low", "high")}
                    for name in MEASURED[protocol]
                }
            )
    return by_protocol


UNITS = {
    "total_mass": "kg",
    "leg_mass": "kg",
    "leg_length": "m",
    "standing_height": "m",
    "height": "m",
    "max_joint_torque": "Nm",
    "single_joint_speed": "rad/s",
    "torque_alone": "Nm",
    "swing_inertia": "kg m^2",
    "contact_force": "N",
    "walk.motor_side": "W",
    "walk.joule": "W",
    "walk.mechanical": "W",
}
"""Unit of each measure of `compare`, by the beginning of its name; the others have none."""


JOINTWISE = ("max_joint_torque", "torque_alone", "single_joint_speed")
"""Measures of `compare` with a number for each joint."""
TORQUES_NOTE = (
    "max_joint_torque: derated, whatever the other joints do; torque_alone: the others at zero "
    "torque, not derated"
)


def compare_text(measures: dict[str, Any]) -> str:
    """Write a comparison for a terminal, with a row for each measure and a column for each design.

    Joints that only some of the designs have follow in a table of their own, so that robots of
    different kinds leave no empty cells.

    Args:
        measures: of each design, by its name.

    Returns:
        The text.
    """
    common = set.intersection(*(set(entry[JOINTWISE[0]]) for entry in measures.values()))
    rows: dict[str, list[object]] = {}
    others: dict[str, list[list[object]]] = {}
    for index, (name, entry) in enumerate(measures.items()):
        for key, value in _flat(entry).items():
            group, _, joint = key.partition(".")
            if group not in JOINTWISE or joint in common:
                rows.setdefault(key, [""] * len(measures))[index] = value
        for joint in entry[JOINTWISE[0]]:
            if joint not in common:
                own = [joint, name, *(entry[group][joint] for group in JOINTWISE)]
                others.setdefault(joint, []).append(own)
    groups = list(dict.fromkeys(key.split(".")[0] for key in rows))
    ordered = sorted(rows, key=lambda key: groups.index(key.split(".")[0]))
    text = table(["measure", "unit", *measures], [[key, _unit(key), *rows[key]] for key in ordered])
    text = f"{text}\n{TORQUES_NOTE}"
    if not others:
        return text
    heads = ["joint", "design", *(f"{group} [{UNITS[group]}]" for group in JOINTWISE)]
    apart = table(heads, [row for some in others.values() for row in some])
    return f"{text}\n\njoints that some of the designs lack:\n{apart}"


def _unit(key: str) -> str:
    """Unit of a row of the comparison; `-` for a number without unit, empty for a text."""
    from hyperleg_design.evaluation.measures import measure_of

    group, *path = key.split(".")
    if group == "variant" or path[-1:] == ["policy"]:
        return ""
    if group.startswith("evaluated "):
        return measure_of(path[0]).unit or "-"
    return UNITS.get(group) or UNITS.get(key) or "-"


def _flat(entry: dict[str, Any], prefix: str = "") -> dict[str, object]:
    flat: dict[str, object] = {}
    for key, value in entry.items():
        flat |= (
            _flat(value, f"{prefix}{key}.")
            if isinstance(value, dict)
            else {f"{prefix}{key}": value}
        )
    return flat
