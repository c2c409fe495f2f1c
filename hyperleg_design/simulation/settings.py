"""Settings of physics, control, starting states and randomisation; every default is assumed unless
the paper is named.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.laws.friction import FRICTION_SPEED
from hyperleg_design.robot.parameters.fields import flag, number, text
from hyperleg_design.robot.parameters.values import Checked


@dataclass(frozen=True, eq=False, kw_only=True)
class Physics(Checked):
    """Settings of MuJoCo's time steps, contacts and solver."""

    time_step: Any = number("s", 1e-5, 0.02, default=0.005)
    """Time step of the simulation [s]; 200 Hz in the paper (Table II)."""
    substeps: Any = number("", 1, 2000, default=4)
    """Simulation steps in one policy step; 4 give 50 Hz (paper, Table II)."""
    cone: Any = text("pyramidal", "elliptic", default="pyramidal")
    """Friction cone."""
    integrator: Any = text("euler", "implicitfast", default="euler")
    """Euler is implicit in joint damping, which is all that this model damps; implicitfast in
    tendon damping as well."""
    contact_dimensions: Any = number("", 3, 6, default=3)
    """3: sliding friction. A foot's pads stand apart and resist twisting together; 4 adds the
    torsion of each pad."""
    iterations: Any = number("", 1, 1000, default=100)
    """Most iterations of the contact solver."""
    tolerance: Any = number("", 0, 1e-2, default=1e-8)
    """Tolerance at which the contact solver stops."""
    friction: Any = text("implicit", "explicit", default="implicit")
    """How joint friction enters a step, see `actuation`."""
    friction_space: Any = text("joint", "motor", default="joint")
    """Where friction acts: at the joints as Table I prints it, or at the motors."""
    friction_velocity: Any = number("rad/s", 1e-4, 10, default=FRICTION_SPEED)
    """Width v_m of the Coulomb friction's tanh [rad/s]; the paper does not print it."""
    posture_dependent: Any = flag(default=False)
    """Reductions from the linkage model at each posture, in place of the printed posture's."""

    def __post_init__(self) -> None:
        Checked.__post_init__(self)
        if (
            self.friction_space == "motor"
            and self.friction == "implicit"
            and self.integrator == "euler"
        ):
            raise InputError(
                "physics",
                "integrator",
                self.integrator,
                "must be implicitfast for implicit friction at the motors",
            )

    @property
    def policy_step(self) -> float:
        """Time between two actions [s]."""
        return float(self.time_step * self.substeps)


@dataclass(frozen=True, eq=False, kw_only=True)
class Control(Checked):
    """How the policy's action becomes joint targets: target = default + scale * EMA(action)."""

    smoothing: Any = number("", 0.01, 1, default=0.2)
    """Weight alpha of the newest action in the moving average (paper, Table II)."""
    scale: Any = number("rad", 0.01, 10, default=0.5)
    """Joint angle of one unit of action [rad]."""
    limit: Any = number("", 0.1, 100, default=10.0)
    """Actions are clipped to plus and minus this."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Start(Checked):
    """Spread of the states that episodes start from: uniform within plus and minus each value about
    standing still.
    """

    joint_position: Any = number("rad", 0, 1, default=0.05)
    """Largest deviation of joint angles from the default posture [rad]."""
    joint_velocity: Any = number("rad/s", 0, 10, default=0.0)
    """Largest joint speed [rad/s]."""
    linear_velocity: Any = number("m/s", 0, 3, default=0.0)
    """Largest speed of the pelvis, forward and sideways [m/s]."""
    tilt: Any = number("rad", 0, 0.5, default=0.02)
    """Roll and pitch of the pelvis [rad]."""
    yaw: Any = number("rad", 0, 3.1416, default=3.1415)
    """Heading [rad]."""
    stride_share: Any = number("", 0, 1, default=0.0)
    """Fraction of episodes that start in mid-stride, at a phase of human walking and about
    1.33 m/s (`human_gait`); the others start standing [-]."""


LATER = ("height_share", "slower", "uneven_floor")
"""Settings that came after trainings and trials were shipped; 0 where they are not used."""


def in_use(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Leave out settings of `LATER` that are not used, so that older files describe the same.

    Args:
        settings: values of one section by name.

    Returns:
        The others.
    """
    return {name: value for name, value in settings.items() if value or name not in LATER}


@dataclass(frozen=True, eq=False, kw_only=True)
class Randomisation(Checked):
    """Differences between simulations, drawn once when the environment is made; none by default, as
    the paper prints none.
    """

    mass: Any = number("", 0, 0.9, default=0.0)
    """Mass and inertia of each body, relative, plus or minus."""
    floor_friction: Any = number("", 0, 0.9, default=0.0)
    """Sliding friction of floor and pads, relative, plus or minus."""
    joint_friction: Any = number("", 0, 1, default=0.0)
    """Coulomb and viscous friction of each joint, relative, plus or minus."""
    gains: Any = number("", 0, 0.9, default=0.0)
    """Stiffness and damping of each joint, relative, plus or minus."""
    push_speed: Any = number("m/s", 0, 3, default=0.0)
    """Largest sudden change of the pelvis's horizontal velocity [m/s]."""
    push_interval: Any = number("s", 0.1, 1000, default=5.0)
    """Mean time between pushes [s]."""
    uneven_floor: Any = number("m", 0, 0.3, default=0.0)
    """From the lowest to the highest point of a floor of random heights [m], one floor for all
    simulations; see `surroundings.UnevenFloor`."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Thermal(Checked):
    """Thermal margin of each motor, h = threshold - EMA of the relative torque, squared; see
    `thermal`.
    """

    reading: Any = text("ema_of_square", "square_of_ema", default="ema_of_square")
    """Which of the two readings of the paper's formula is used."""
    time_constant: Any = number("s", 0.05, 1000, default=3.0)
    """Time constant of the moving average [s] (paper, Section III)."""
    threshold: Any = number("", 0.01, 100, default=1.0)
    """h_th [-]; the paper tunes it and prints no value."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Clock(Checked):
    """Gait clock; a deviation from the paper."""

    period: Any = number("s", 0.1, 5, default=1.0)
    """Duration of a stride [s]."""
    stance: Any = number("", 0.3, 0.9, default=0.62)
    """Fraction of the stride for which each foot should stand [-]."""
    shown: Any = number("", 0, 1, default=1.0)
    """Gain of the clock in the observation [-]; at 0 a policy that has the input knows no time."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Limits(Checked):
    """Conditions that end an episode."""

    height: Any = number("m", 0.0, 3, default=0.55)
    """Pelvis below this has fallen [m]."""
    height_share: Any = number("", 0, 0.95, default=0.0)
    """Share of the base's height in the robot's default posture below which it has fallen, in place
    of `height`; 0 leaves `height` [-]."""
    tilt: Any = number("rad", 0.1, 3.2, default=0.9273)
    """Pelvis leaning more than this has fallen [rad]; cos 0.9273 = 0.6."""
    duration: Any = number("s", 0.1, 10000, default=20.0)
    """Duration of an episode [s] (paper, Table II); its end is a truncation."""
    deviation: Any = number("m", 0.1, 1000, default=4.0)
    """Farther than this from the path to a waypoint an episode is truncated [m]."""

    def of(self, default_height: Any) -> Limits:
        """Convert a height that is given as a share of the default posture's into metres.

        Args:
            default_height: of the base's origin in the robot's default posture [m], `()` or `(n,)`.

        Returns:
            The limits of the robot.
        """
        if not self.height_share:
            return self
        height = self.height_share * np.asarray(default_height, float)
        return dataclasses.replace(self, height=height if height.ndim else float(height))
