"""Power of recorded trials: the whole robot's ledger, joint by joint, motor by motor, and over the
gait cycle.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.evaluation.motion.gait import CYCLE_POINTS, Steps, cycles, strides
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.sizing.energy import EnergyLedger, energy_ledger, joint_power

if TYPE_CHECKING:
    from hyperleg_design.evaluation.rollout import Trial

GROUPS = {
    "hip": ("hip_yaw", "hip_roll", "hip_pitch"),
    "knee": ("knee",),
    "ankle": ("ankle_pitch", "ankle_roll"),
    "toe": ("toe",),
}
"""Joints of each part of Fig. 6."""
LEG_MEANS = (
    *(f"{group}{kind}" for group in GROUPS for kind in ("", "_positive", "_absolute")),
    "joule",
    "total",
)
"""Keys of `CyclePower.means`."""
FLOWS = (
    "motor_side",
    "joule",
    "mechanical",
    "mechanical_positive",
    "mechanical_negative",
    "driver_loss",
    "battery",
)
"""Powers of `EnergyLedger` that `flows` sums over all motors."""


def ledger(trial: Trial, first: int = 0, last: int | None = None) -> EnergyLedger:
    """Compute the energy ledger of all motors between two samples.

    Args:
        trial: the recorded trial.
        first: first sample that counts.
        last: first sample that does not count any more; all by default.

    Returns:
        Power of each of the K motors at each sample [W], `(t, K)`.
    """
    part = slice(first, last)
    constants = power_constants(trial)
    electrical = trial.design.electrical_section
    return energy_ledger(
        trial.motor_torque[part],
        trial.motor_velocity[part],
        trial.time_step,
        constants,
        electrical.efficiency_out,
        electrical.efficiency_regen,
    )


def power_constants(trial: Trial) -> np.ndarray:
    """Look up the power constants of all motors as they were simulated.

    Args:
        trial: the recorded trial.

    Returns:
        Joule heat over squared torque [W/Nm^2], `(K,)`.
    """
    if trial.power_constant is not None:
        return trial.power_constant
    layout = trial.layout
    return np.tile(
        motor_arrays(trial.design).power_constant[: layout.leg_motors], len(layout.limbs)
    )


def flows(entries: EnergyLedger) -> dict[str, float]:
    """Compute the mean power of the whole robot.

    Args:
        entries: of all motors.

    Returns:
        Power in each of `FLOWS` [W]; `motor_side` is the total that the paper prints.
    """
    total = entries.mean_power().total()
    return {name: float(getattr(total, name)) for name in FLOWS}


@dataclass(frozen=True, eq=False)
class CyclePower:
    """Power of one leg over the normalised gait cycle, one row a stride; q joints, m motors of the
    leg.
    """

    joints: tuple[str, ...]
    """Without the side, `(q,)`."""
    motors: tuple[str, ...]
    """Without the side, `(m,)`."""
    mechanical: np.ndarray
    """Given by the motors to each joint, signed [W], `(strides, points, q)`."""
    joule: np.ndarray
    """Heat of each motor [W], `(strides, points, m)`."""
    means: Mapping[str, float]
    """Means over the strides' samples [W]: `{group}`, `{group}_positive`, `{group}_absolute`
    mechanical, taken joint by joint; `joule` of all motors; `total`, to which signed groups and
    `joule` add up."""

    def of_group(self, group: str) -> np.ndarray:
        """Sum the mechanical power of one part of the leg.

        Args:
            group: one of `GROUPS`.

        Returns:
            The power [W], `(strides, points)`; zero for a toe that the robot does not have.
        """
        columns = [i for i, joint in enumerate(self.joints) if joint in GROUPS[group]]
        return np.asarray(self.mechanical[..., columns].sum(-1))


def cycle_power(
    trial: Trial, steps: Steps, foot: int = 1, points: int = CYCLE_POINTS
) -> CyclePower:
    """Compute the power of one leg over its strides.

    Args:
        trial: the trial.
        steps: those whose strides count.
        foot: 0 left, 1 right (the paper's Fig. 6).
        points: of the normalised cycle.

    Returns:
        Power of joints and motors over the normalised cycle, and their means over time.
    """
    layout = trial.layout
    joints, motors = (
        slice(foot * n, (foot + 1) * n) for n in (layout.leg_joints, layout.leg_motors)
    )
    constants = power_constants(trial)[motors]
    mechanical = joint_power(trial.driven_joint_torque[:, joints], trial.joint_velocity[:, joints])
    joule = constants * trial.motor_torque[:, motors] ** 2
    names = layout.own_joints
    begins, ends = strides(steps, foot)
    whole = slice(int(begins[0]), int(ends[-1])) if len(begins) else slice(0)
    return CyclePower(
        joints=names,
        motors=layout.own_motors,
        mechanical=cycles(mechanical, steps, foot, points),
        joule=cycles(joule, steps, foot, points),
        means=leg_means(names, mechanical[whole], joule[whole]),
    )


def leg_means(joints: Sequence[str], mechanical: np.ndarray, joule: np.ndarray) -> dict[str, float]:
    """Compute the mean powers of one leg.

    Args:
        joints: names without the side, `(q,)`.
        mechanical: given to each joint [W], `(t, q)`.
        joule: heat of each motor [W], `(t, m)`.

    Returns:
        Means by name [W], see `CyclePower.means`; NaN without samples.
    """
    if not len(mechanical):
        return dict.fromkeys(LEG_MEANS, np.nan)
    means: dict[str, float] = {}
    for group, names_of in GROUPS.items():
        part = mechanical[:, [i for i, joint in enumerate(joints) if joint in names_of]]
        means[group] = float(part.sum(-1).mean())
        means[f"{group}_positive"] = float(np.maximum(part, 0.0).sum(-1).mean())
        means[f"{group}_absolute"] = float(np.abs(part).sum(-1).mean())
    means["joule"] = float(joule.sum(-1).mean())
    means["total"] = means["joule"] + sum(means[group] for group in GROUPS)
    return means
