"""Fixed tendons of an MJCF as MuJoCo reads them: what they add to the dynamics of the joints.

A fixed tendon has the length l = sum_j c_j q_j. Its armature, damping, dry friction and stiffness
act along l, so that with the row c of coefficients (MuJoCo's documentation, `tendon/fixed`)

    M  += armature c^T c
    tau = -c^T (damping c v + frictionloss sign(c v) + stiffness (c q - l_0))

The gear of an actuator that pulls the tendon multiplies that actuator's force only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class Tendon:
    """One fixed tendon over the joints of a robot."""

    index: int
    """Index of the tendon in the file."""
    name: str
    """In the file, or `tendon_INDEX`."""
    coefficients: np.ndarray
    """Change of length over each joint's position `(n,)` [-, or m/rad]."""
    armature: float
    """Inertia along the tendon [kg m^2 or kg]."""
    damping: float
    """Viscous friction along the tendon [Nms/rad or N s/m]."""
    frictionloss: float
    """Dry friction along the tendon [Nm or N]."""
    stiffness: float
    """Of its spring [Nm/rad or N/m]."""
    rest: tuple[float, float]
    """Lengths between which its spring is slack, joints outside this robot's counted at their
    reference [rad or m]."""

    @property
    def single(self) -> bool:
        """Whether it acts on one joint alone."""
        return int(np.count_nonzero(self.coefficients)) == 1

    @property
    def passive(self) -> bool:
        """Whether it has friction or a spring."""
        return bool(self.damping or self.frictionloss or self.stiffness)

    @property
    def inertia(self) -> np.ndarray:
        """What it adds to the mass matrix `(n, n)`."""
        return self.armature * np.outer(self.coefficients, self.coefficients)


def fixed_tendons(model: Any, joints: Sequence[int]) -> list[Tendon]:
    """Fixed tendons that reach some of a robot's joints.

    Args:
        model: compiled MuJoCo model.
        joints: its indices of the robot's joints `(n,)`.

    Returns:
        In the order of the file; tendons around sites or shapes are left out.
    """
    import mujoco

    place = {int(joint): row for row, joint in enumerate(joints)}
    tendons = []
    for index in range(model.ntendon):
        wraps = slice(model.tendon_adr[index], model.tendon_adr[index] + model.tendon_num[index])
        if model.wrap_type[wraps.start] != mujoco.mjtWrap.mjWRAP_JOINT:
            continue
        coefficients, beside = np.zeros(len(place)), 0.0
        for joint, factor in zip(model.wrap_objid[wraps], model.wrap_prm[wraps], strict=True):
            if int(joint) in place:
                coefficients[place[int(joint)]] += factor
            else:
                beside += float(factor * model.qpos0[model.jnt_qposadr[joint]])
        if not coefficients.any():
            continue
        low, high = (float(value) - beside for value in model.tendon_lengthspring[index])
        tendons.append(
            Tendon(
                index,
                model.tendon(index).name or f"tendon_{index}",
                coefficients,
                float(model.tendon_armature[index]),
                _first(model.tendon_damping[index]),
                float(model.tendon_frictionloss[index]),
                _first(model.tendon_stiffness[index]),
                (low, high),
            )
        )
    return tendons


def fold_into_joints(spec: Any, tendons: Sequence[Tendon], joints: Sequence[str]) -> list[str]:
    """Give joints the friction and springs of the tendons that act on them alone.

    Args:
        spec: model, whose joints change in place.
        tendons: of the same model.
        joints: names `(n,)`.

    Returns:
        A note for every tendon whose friction or spring has no place at a single joint.
    """
    notes = []
    named = {joint.name: joint for joint in spec.joints}
    for tendon in tendons:
        if not tendon.passive:
            continue
        low, high = tendon.rest
        if not tendon.single or (tendon.stiffness and high > low):
            what = "couples joints" if not tendon.single else "has a slack spring"
            notes.append(f"tendon {tendon.name} {what}: its friction and spring are left out")
            continue
        row = int(np.flatnonzero(tendon.coefficients)[0])
        factor, joint = float(tendon.coefficients[row]), named[joints[row]]
        joint.frictionloss += abs(factor) * tendon.frictionloss
        damping, stiffness = np.array(joint.damping), np.array(joint.stiffness)
        damping.flat[0] += factor**2 * tendon.damping
        own, added = float(stiffness.flat[0]), factor**2 * tendon.stiffness
        if added:
            joint.springref = (own * joint.springref + added * low / factor) / (own + added)
            stiffness.flat[0] += added
        joint.damping, joint.stiffness = damping, stiffness
    return notes


def _first(value: Any) -> float:
    """The linear coefficient, where MuJoCo keeps further ones of a polynomial."""
    return float(np.ravel(value)[0])
