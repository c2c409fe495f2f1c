"""Joint friction over motors and reductions.

Table I prints Coulomb and viscous friction per joint, of one build. Law `reflected` splits both into
a part of motors and gears, which the reductions reflect to the joint, and a part of the joint itself
(bearings, belts), which stays. A motor's own coefficients f_m (Coulomb) and d_m (viscous) are in
proportion to its peak torque, so at joint j, with s the motors' share and M_ref, f_ref, d_ref of the
reference build,

    coulomb_j = F_j (1 + s (sum_m |M_jm| f_m / sum_m |M_ref,jm| f_ref,m - 1)) + load_j
    viscous_j = D_j (1 + s (sum_m M_jm^2 d_m / sum_m M_ref,jm^2 d_ref,m - 1))

with F_j, D_j the declared friction and load_j the loss under load of other reductions (`gear`). At the
reference build this is the declared friction for every s, and the constant of proportion cancels. A
motor that is not installed has no friction. Another law is one function, registered with
`friction_law`.
"""  # noqa: E501

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from hyperleg_design.robot import transmission
from hyperleg_design.robot.laws import gear
from hyperleg_design.robot.laws.laws import Laws
from hyperleg_design.robot.names import JOINTS
from hyperleg_design.robot.trees import tree_limb
from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.robot.parameters.hyperleg import HyperLeg

FRICTION_SPEED = 0.1
"""Width v_m of the Coulomb friction's tanh [rad/s] (assumed; the paper does not print it)."""

Law = Callable[["HyperLeg | TreeDesign"], tuple[np.ndarray, np.ndarray]]
_LAWS: Laws[Law] = Laws("friction")
friction_law = _LAWS.register
"""Registers a law of friction under the name that `friction.law` uses."""


def joint_friction(design: RobotDesign) -> tuple[np.ndarray, np.ndarray]:
    """Friction of the joints of one limb by the design's law.

    Args:
        design: a robot or batch.

    Returns:
        Coulomb [Nm] and viscous [Nms/rad] friction, each `(..., joints)`; of HyperLeg, of all
        seven in the order of `JOINTS`, where a locked toe's has no effect and a passive toe's
        damper is part of the viscous one.

    Raises:
        InputError: no such law.
    """
    design = cast("HyperLeg | TreeDesign", design)
    coulomb, viscous = _LAWS.of(design)(design)
    if not isinstance(design, TreeDesign) and design.toe.joint == "passive":
        place = np.arange(len(JOINTS)) == JOINTS.index("toe")
        viscous = viscous + np.expand_dims(design.toe.damping, -1) * place
    return coulomb, viscous


@friction_law("declared")
def declared(design: HyperLeg | TreeDesign) -> tuple[np.ndarray, np.ndarray]:
    """Keep the declared friction, whatever motors and reductions.

    Args:
        design: a robot or batch.

    Returns:
        Coulomb friction [Nm] and viscous friction [Nms/rad] of each joint, `(..., joints)`.
    """
    return _declared(design, "coulomb"), _declared(design, "viscous")


@friction_law("reflected")
def reflected(design: HyperLeg | TreeDesign) -> tuple[np.ndarray, np.ndarray]:
    """Reflect the motors' share of the friction through the reductions; see the module.

    Args:
        design: a robot or batch.

    Returns:
        Coulomb friction [Nm] and viscous friction [Nms/rad] of each joint, `(..., joints)`.
    """
    share = np.expand_dims(design.friction.motor_share, -1)
    matrix, reference = gear.absolute_reductions(design)
    peak, reference_peak = gear.peak_torques(design)
    peak = peak * gear.installed(design)

    def scaled(field: str, power: int) -> np.ndarray:
        now = transmission.joint_torque(matrix**power, peak)
        then = transmission.joint_torque(reference**power, reference_peak)
        return np.asarray(_declared(design, field) * (1.0 + share * (now / then - 1.0)))

    coulomb = scaled("coulomb", 1) + gear.gear_change(design).load_torque
    return np.maximum(coulomb, 0.0), scaled("viscous", 2)


def _declared(design: HyperLeg | TreeDesign, field: str) -> np.ndarray:
    if isinstance(design, TreeDesign):
        return tree_limb.of_joints(design, field)
    values: list[Any] = [getattr(getattr(design.joints, joint), field) for joint in JOINTS]
    return np.stack(np.broadcast_arrays(*values), -1).astype(float)
