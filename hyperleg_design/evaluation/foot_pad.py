"""Which foot pad a contact's settings stand for: stiffness and damping of a soft sole under the
heel, against MuJoCo's `solref`.

With time constant T and damping ratio zeta, MuJoCo's contact is a spring and damper of the
frequency w = 1 / (zeta T) whatever it carries (`mujoco/doc/modeling.rst`, deeper than the width of
`solimp`). The stiffness it stands for is therefore that of the mass behind the contact, K = m w^2,
with the damping 2 zeta m w = 2 m / T. At touchdown that mass is the effective one of the foot,
rotors included.

The pad: a sole as thick as the radius of the design's sole pads, bearing on the circles of those
behind the ankle, K = E A / h. Foams for soles have moduli of some 0.1 to 10 MPa, solid rubber 1 to
10 MPa.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.simulation.layout import layout_of

if TYPE_CHECKING:
    from hyperleg_design.evaluation.rollout import Trial
    from hyperleg_design.robot.parameters.described import RobotDesign


@dataclass(frozen=True)
class FootPad:
    """A sole under one heel."""

    modulus: float
    """Modulus of the material in compression [Pa]."""
    thickness: float
    """Thickness [m]."""
    area: float
    """Area that bears load [m^2]."""
    damping_ratio: float
    """Damping ratio with the robot's mass on the pad [-]."""

    @property
    def stiffness(self) -> float:
        """Stiffness of the pad under compression, k = E A / h [N/m]."""
        return self.modulus * self.area / self.thickness

    def damping(self, mass: float) -> float:
        """Compute the damping of the pad under a mass.

        Args:
            mass: that the pad carries [kg].

        Returns:
            The damping [Ns/m].
        """
        return float(2 * self.damping_ratio * np.sqrt(self.stiffness * mass))

    def time_constant(self, mass: float) -> float:
        """Compute the time constant of MuJoCo's contact that stands for this pad.

        Args:
            mass: that the pad carries [kg].

        Returns:
            The time constant [s].

        Raises:
            InputError: a mass that is not positive.
        """
        if not mass > 0:
            raise InputError("foot pad", "mass", mass, "expects a positive mass [kg]")
        return float(np.sqrt(mass / self.stiffness) / self.damping_ratio)


def pad_of_contact(design: RobotDesign, mass: float, time_constant: float | None = None) -> FootPad:
    """Compute the foot pad that a design's contact settings stand for.

    Args:
        design: gives pads, damping ratio and time constant.
        mass: behind the contact [kg].
        time_constant: instead of the design's [s].

    Returns:
        The pad with its elastic modulus, thickness, area and damping ratio.

    Raises:
        InputError: no mass.
    """
    if not mass > 0:
        raise InputError("foot pad", "mass", mass, "expects a positive mass [kg]")
    contact = design.contact_section
    constant = float(contact.time_constant if time_constant is None else time_constant)
    thickness = float(contact.pad_radius)
    area = heel_area(design)
    stiffness = mass / (constant * float(contact.damping_ratio)) ** 2
    return FootPad(stiffness * thickness / area, thickness, area, float(contact.damping_ratio))


def heel_area(design: RobotDesign) -> float:
    """Compute the area of the sole pads behind the ankle of one foot.

    Args:
        design: gives the pads, each a circle.

    Returns:
        The area [m^2].
    """
    layout = layout_of(design)
    count = int(np.sum((layout.pad_foot == 0) & (layout.pad_position[:, 0] < 0)))
    return float(count * np.pi * design.contact_section.pad_radius**2)


def heel_mass(trial: Trial, samples: Any, feet: Any) -> np.ndarray:
    """Effective vertical mass of a foot at its heel, joints free but for their inertia, rotors
    included [kg].

    Args:
        trial: a recorded trial.
        samples: of touchdowns, `(k,)`.
        feet: which foot touches down, 0 left, 1 right, `(k,)`.

    Returns:
        1 / (J M^-1 J^T) of the mean of the pads behind the ankle, `(k,)`.
    """
    import mujoco

    model, layout = trial.model, trial.layout
    data = mujoco.MjData(model)
    masses = []
    for sample, foot in zip(np.asarray(samples, int), np.asarray(feet, int), strict=True):
        data.qpos[:3], data.qpos[3:7], data.qpos[7:] = (
            trial.base_position[sample],
            trial.base_orientation[sample],
            trial.joint_position[sample],
        )
        mujoco.mj_fwdPosition(model, data)
        pads = np.flatnonzero((layout.pad_foot == foot) & (layout.pad_position[:, 0] < 0))
        jacobian = np.zeros((3, model.nv))
        row = np.zeros(model.nv)
        for pad in pads:
            geom = model.geom(layout.pads[pad]).id
            mujoco.mj_jac(
                model, data, jacobian, None, data.geom_xpos[geom], model.geom_bodyid[geom]
            )
            row += jacobian[2] / len(pads)
        solved = np.zeros((1, model.nv))
        mujoco.mj_solveM(model, data, solved, row[None])
        masses.append(1.0 / float(row @ solved[0]))
    return np.array(masses)
