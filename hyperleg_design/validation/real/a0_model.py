"""The model of the double pendulum A.0 as an MJCF file, from the parameters that its makers
identified, whole or with something left out.

The makers' equation of motion (angles from the hanging posture, q2 relative to link 1; `I1`, `I2`
about the joints, `Ir` of the rotors before gears of ratio `gr`):

    M11 = I1 + I2 + m2 l1^2 + 2 m2 l1 r2 cos q2 + gr^2 Ir,   M12 = I2 + m2 l1 r2 cos q2,
    M22 = I2 + gr^2 Ir,   friction = cf arctan(100 v) + b v.

MuJoCo's Coulomb friction is taken as the limit of the makers' law, cf pi / 2. Their terms Ir in M11
and -gr Ir in M12 (0.1 and 2 % of M) are left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

from hyperleg_design.errors import InputError
from hyperleg_design.reading import given_path, read_yaml

JOINTS = ("shoulder", "elbow")
LINKS = ("upper", "lower")
KEYS = ("m1", "m2", "r1", "r2", "I1", "I2", "l1", "l2", "Ir", "gr", "cf1", "cf2", "b1", "b2", "g")
"""Of the makers' file."""
TIP_MASS = 0.5
"""Of the weight at the end of link 2 [kg] (makers' description of design A.0)."""


@dataclass(frozen=True)
class DoublePendulum:
    """Parameters of the two links and drives, SI units, one value a link or joint."""

    mass: tuple[float, float]
    com: tuple[float, float]
    """Distance of the centre of mass from the joint [m]."""
    inertia: tuple[float, float]
    """About the joint [kg m^2]."""
    length: tuple[float, float]
    armature: tuple[float, float]
    """Rotor inertia at the joint, gr^2 Ir [kg m^2]."""
    coulomb: tuple[float, float]
    """Coulomb friction at the joint [Nm]."""
    viscous: tuple[float, float]
    """Viscous friction [Nms/rad]."""
    gravity: float = 9.81

    def without_tip(self) -> DoublePendulum:
        """The model with the weight at the tip left out of link 2."""
        return self.without_load(1, TIP_MASS, self.length[1])

    def without_load(self, link: int, load: float, down: float) -> DoublePendulum:
        """The model with a point mass left out of a link.

        Args:
            link: 0 or 1.
            load: the mass [kg].
            down: its distance from the link's joint [m].

        Returns:
            The model.
        """
        mass, com, inertia = list(self.mass), list(self.com), list(self.inertia)
        moment = mass[link] * com[link] - load * down
        mass[link] -= load
        com[link] = moment / mass[link]
        inertia[link] -= load * down**2
        return replace(
            self,
            mass=(mass[0], mass[1]),
            com=(com[0], com[1]),
            inertia=(inertia[0], inertia[1]),
        )

    def without_friction(self, *joints: str) -> DoublePendulum:
        """The model with Coulomb and viscous friction left out at some joints.

        Args:
            joints: their names.

        Returns:
            The model.
        """
        keep = [name not in joints for name in JOINTS]
        return replace(
            self,
            coulomb=(self.coulomb[0] * keep[0], self.coulomb[1] * keep[1]),
            viscous=(self.viscous[0] * keep[0], self.viscous[1] * keep[1]),
        )

    def without_rotors(self) -> DoublePendulum:
        """The model with the inertia of both rotors left out."""
        return replace(self, armature=(0.0, 0.0))

    def mjcf(self) -> str:
        """The model as an MJCF file: hinges about y, links hang along -z, motors at the joints."""
        central = [i - m * c**2 for i, m, c in zip(self.inertia, self.mass, self.com, strict=True)]
        bodies, closing = "", ""
        place = "0 0 1"
        for k in (0, 1):
            bodies += (
                f'<body name="{LINKS[k]}" pos="{place}">'
                f'<inertial pos="0 0 {-self.com[k]!r}" mass="{self.mass[k]!r}" '
                f'diaginertia="{central[k]!r} {central[k]!r} {central[k] / 10!r}"/>'
                f'<joint name="{JOINTS[k]}" axis="0 1 0" armature="{self.armature[k]!r}" '
                f'frictionloss="{self.coulomb[k]!r}" damping="{self.viscous[k]!r}"/>\n'
            )
            place = f"0 0 {-self.length[k]!r}"
            closing += "</body>"
        motors = "".join(f'<motor name="{j}" joint="{j}"/>' for j in JOINTS)
        return (
            '<mujoco model="double_pendulum_a0"><compiler angle="radian"/>'
            f'<option gravity="0 0 {-self.gravity!r}"/><worldbody>\n{bodies}{closing}'
            f"</worldbody><actuator>{motors}</actuator></mujoco>\n"
        )


def read_model(path: Path) -> DoublePendulum:
    """The makers' `model_*.yml`.

    Args:
        path: of the file.

    Returns:
        The model.

    Raises:
        InputError: unreadable, or a parameter is missing or no number.
    """
    content = read_yaml(path)
    values = {}
    for key in KEYS:
        value = content.get(key)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(given_path(path), key, value, "expects a number")
        values[key] = float(value)
    rotor = values["gr"] ** 2 * values["Ir"]

    def pair(key: str, factor: float = 1.0) -> tuple[float, float]:
        return (factor * values[f"{key}1"], factor * values[f"{key}2"])

    return DoublePendulum(
        mass=pair("m"),
        com=pair("r"),
        inertia=pair("I"),
        length=pair("l"),
        armature=(rotor, rotor),
        coulomb=pair("cf", math.pi / 2),
        viscous=pair("b"),
        gravity=values["g"],
    )
