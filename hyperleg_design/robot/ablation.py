"""Ablations of the active toe, made from any design, and what each takes away besides the toe."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, TypeVar

from hyperleg_design.errors import InputError
from hyperleg_design.robot import masses, transmission
from hyperleg_design.robot.names import JOINTS, LAYOUTS, PASSIVE, VARIANTS

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.hyperleg import HyperLeg

Biped = TypeVar("Biped", bound="HyperLeg")

DESCRIPTION = {
    "toe": "active toe",
    "toe_locked": "toe joint locked, its motor kept: the motor still helps knee and ankle",
    "toe_removed_matched": "toe joint and motor gone; total mass, sole and foot length kept by "
    "ballast at the motor's place",
    "toe_removed": "toe joint and motor gone with their mass; the sole keeps its length",
    PASSIVE: "a spring and a damper at the toe in place of the motor; total mass kept by ballast "
    "at the motor's place",
}


def states(variant: str) -> tuple[str, bool]:
    """State what a toe layout is.

    Args:
        variant: name of the layout, such as `toe_locked`.

    Returns:
        The value of `toe.joint`, and whether the motor of the toe is installed.
    """
    if variant == "toe":
        return "active", True
    return "passive" if variant == PASSIVE else "locked", variant == "toe_locked"


def ablate(design: Biped, variant: str) -> Biped:
    """The design with one ablation.

    Args:
        design: a robot or batch with an active toe.
        variant: one of `LAYOUTS`.

    Returns:
        A design of the same batch shape whose `variant` is the one asked for.

    Raises:
        InputError: no such variant, or the toe is gone already.
    """
    if variant not in LAYOUTS:
        raise InputError("variant", "", variant, f"expects one of {', '.join(LAYOUTS)}")
    if variant == design.variant:
        return design
    if design.variant != "toe":
        raise InputError(
            design.name,
            "variant",
            design.variant,
            f"has no active toe to make {variant} of; start from the toe variant",
        )
    joint, installed = states(variant)
    values: dict[str, Any] = {"toe.joint": joint, "actuators.toe_installed": installed}
    if variant in ("toe_removed_matched", PASSIVE):
        without = masses.mass_table(design.with_values(values, f"variant {variant}"))
        values["masses.thigh_ballast"] = (
            design.masses.thigh_ballast + (masses.mass_table(design).total - without.total) / 2
        )
    if variant == "toe_removed":
        values["toe.mass"] = 0.0
    ablated = design.with_values(values, f"variant {variant}", label="derived")
    return dataclasses.replace(ablated, variant=variant)


def variants(design: Biped) -> dict[str, Biped]:
    """All ablations of a design, by name.

    Args:
        design: a robot or batch with an active toe.

    Returns:
        Designs by the name of their variant, the unchanged one, `toe`, first.
    """
    return {name: ablate(design, name) for name in VARIANTS}


def confound(design: HyperLeg, posture: str = "standing") -> dict[str, Any]:
    """What each ablation takes away besides the toe.

    Args:
        design: one robot with an active toe.
        posture: `standing` or `walking`, the paper's two; the joint torques are of this one.

    Returns:
        By variant: `removes` (text), `motors` and `joints` a leg, `total_mass` [kg], `leg_mass`
        [kg], and `max_joint_torque` [Nm] by joint, derated as in Table I, with `lost` [Nm] against
        the active toe.
    """
    full = dict(zip(JOINTS, transmission.max_joint_torque(design, posture).tolist(), strict=False))
    effects: dict[str, Any] = {}
    for name, variant in variants(design).items():
        table = masses.mass_table(variant)
        joints = transmission.joint_names(variant)
        torque = dict(
            zip(joints, transmission.max_joint_torque(variant, posture).tolist(), strict=True)
        )
        effects[name] = {
            "removes": DESCRIPTION[name],
            "joints": len(joints),
            "motors": len(transmission.motor_names(variant)),
            "total_mass": float(table.total),
            "leg_mass": float(table.leg),
            "max_joint_torque": torque,
            "lost": {j: full[j] - torque[j] for j in torque},
        }
    return effects
