"""The analysis of a robot whose design writes its tree out, in its default posture: what
`analysis.analyze` says of HyperLeg, for any limbs.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.checks.check_pads import hanging_pads
from hyperleg_design.robot.kinematics.dimensions import limb_mass, standing_height, total_mass
from hyperleg_design.robot.models import leg_reflected_inertia
from hyperleg_design.robot.motors import find_motor
from hyperleg_design.robot.trees import limb_masses, tree_limb
from hyperleg_design.robot.trees.rod_range import rod_ranges
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.sizing import zonotope
from hyperleg_design.sizing.capability import DIRECTIONS, largest_force
from hyperleg_design.sizing.envelope import motor_envelope

SCHEMA = 1
"""Version of the object that `analyze_tree` returns."""
NO_PADS = "has no pads, so it pushes on nothing; name its feet under pads"


def analyze_tree(design: TreeDesign) -> dict[str, Any]:
    """Analyse one robot, its joints and motors those of one limb.

    Args:
        design: one robot; batches are refused.

    Returns:
        Plain numbers, lists and mappings, SI units, ready for JSON: `limbs` (names of the copies,
        none where the robot is described as a whole), `total_mass`, `limb_mass` [kg] (of the links
        that move against the root), `standing_height` [m], `link_mass` [kg], `reduction` (joints x
        motors), `max_joint_torque` [Nm] (derated), `torque_alone` [Nm] (the others at zero, not
        derated), `single_joint_speed` [rad/s], `reflected_inertia` [kg m^2] (joints x joints),
        `link_inertia` [kg m^2] (of what is behind each joint, about it, rotors not in it),
        `zonotope_to_box_volume` [-], `motors`, `linkages` (for each motor with a rod `reduction`,
        its smallest and largest by joint, `default` and `beyond`, as `RodRange` has them), and
        `contact_force` by direction: `force` [N] (the largest component of one limb's force on the
        floor that way; the other components are whatever they must be), `body_weights` [-],
        `binding` motors and joints at their `derated` torque, or the `reason` why there is none;
        `hanging_pads` (heights [m] above the lowest pad of pads in the air, by name; the forces are
        those of the lowest pads of the limb).

    Raises:
        InputError: a batch of designs.
    """
    if design.batch_shape:
        raise InputError(design.name, "", None, "holds a batch of designs; take one of them")
    joints, matrix = transmission.joint_names(design), transmission.joint_from_motor(design)
    limit = motor_envelope(design).standstill_torque
    default = tree_limb.default_position(design)
    unknown = design.trunk.motion == "floating" and not design.pad_sections

    def named(values: Any) -> dict[str, float]:
        return dict(zip(joints, np.asarray(values, float).tolist(), strict=True))

    return {
        "schema": SCHEMA,
        "family": "tree",
        "design": design.name,
        "limbs": [copy for copy in design.copies if copy],
        "total_mass": float(total_mass(design)),
        "limb_mass": float(limb_mass(design)),
        "standing_height": None if unknown else float(standing_height(design)),
        "link_mass": {
            name: float(body.mass) for name, body in limb_masses.limb_masses(design).links.items()
        },
        "joints": list(joints),
        "motors": _motors(design),
        "reduction": matrix.tolist(),
        "max_joint_torque": named(transmission.max_joint_torque(design)),
        "torque_alone": named(
            [zonotope.alone(matrix, -limit, limit, row) for row in range(len(joints))]
        ),
        "single_joint_speed": named(transmission.single_joint_speed(design)),
        "reflected_inertia": leg_reflected_inertia(design).tolist(),
        "link_inertia": named([limb_masses.behind(design, name, default)[2] for name in joints]),
        "zonotope_to_box_volume": float(zonotope.zonotope_to_box_volume(matrix, -limit, limit)),
        "linkages": {
            rod.motor: {
                "reduction": {joint: list(ends) for joint, ends in rod.reduction.items()},
                "default": rod.default,
                "beyond": rod.beyond,
            }
            for rod in rod_ranges(design)
        },
        "contact_force": _forces(design),
        "hanging_pads": hanging_pads(design),
    }


def _forces(design: TreeDesign) -> dict[str, Any]:
    """Largest contact forces of the first limb in the default posture, derated, by direction."""
    forces: dict[str, Any] = {}
    for direction in DIRECTIONS:
        if not design.pad_sections:
            forces[direction] = {"force": None, "reason": NO_PADS}
            continue
        try:
            side = design.copies[0]
            force = largest_force(design, "default", direction, side=side, derated=True)
        except InfeasibleError as error:
            forces[direction] = {"force": None, "reason": str(error)}
            continue
        forces[direction] = {
            "force": float(force.force @ DIRECTIONS[direction]),
            "body_weights": force.body_weights,
            "binding": list(force.binding),
            "derated": list(force.derated),
        }
    return forces


def _motors(design: TreeDesign) -> dict[str, Any]:
    kind, ratio = str(design.electrical.constants), design.electrical.voltage_ratio
    motors = {}
    for name, actuator in design.actuator_sections.items():
        motor = find_motor(str(actuator.motor))
        motors[name] = {
            "motor": motor.name,
            "gear": float(actuator.gear),
            "no_load_speed": motor.no_load_speed(kind) * ratio,
            "peak_torque": motor.peak_torque(kind),
            "rated_torque": motor.rated_torque,
            "stall_torque": motor.stall_torque(kind) * ratio,
            "power_constant": motor.power_constant(kind),
            "rotor_inertia": motor.rotor_inertia,
            "mass": motor.mass,
        }
    return motors
