"""Alterations of what is around a robot, or of what its drives are built of: slopes, uneven floors,
errors of torque constants. `evaluation.robustness` asks how a policy bears them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from typing_extensions import override

from hyperleg_design.errors import InputError
from hyperleg_design.robot.mjcf import FLOOR
from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.simulation.alteration import Alteration, Live, Tick

if TYPE_CHECKING:
    import mujoco

STEEPEST = 30.0
"""Slope either way [deg]."""
CELL = 0.2
"""Edge of a cell of the uneven floor [m]; assumed."""
EDGE = 90.0
"""Length of the sides of the uneven floor, with the start in its middle [m]: walks of 20 s at 2 m/s
end on it."""
FLAT = 0.6
"""Half the edge of the flat square that robots start on [m]."""
_THICK = 0.5
"""Thickness of the uneven floor below its lowest point [m]."""


@dataclass(frozen=True, eq=False)
class Slope(Alteration):
    """A floor that rises along x by some angle, seen from the floor: gravity leans instead."""

    degrees: float
    """Uphill along x positive [deg]."""

    def __post_init__(self) -> None:
        if not abs(self.degrees) <= STEEPEST:
            remedy = f"expects -{STEEPEST:g} .. {STEEPEST:g} degrees"
            raise InputError("slope", "degrees", self.degrees, remedy)

    @property
    def vertical(self) -> np.ndarray:
        """Against gravity, in the frame whose z is normal to the floor."""
        angle = np.deg2rad(self.degrees)
        return np.array([np.sin(angle), 0.0, np.cos(angle)])

    @override
    def edit(self, model: mujoco.MjModel, simulation: int = 0) -> None:
        """Turn gravity, so that the level floor is a slope."""
        model.opt.gravity[:] = -GRAVITY * self.vertical


@dataclass(frozen=True, eq=False)
class UnevenFloor(Alteration):
    """A floor of random heights, linear between points `CELL` apart and flat where robots start."""

    height: float
    """From the lowest to the highest point [m]."""
    seed: int = 0
    """Of the heights."""

    def __post_init__(self) -> None:
        if not 0 < self.height <= 0.3:
            raise InputError("uneven floor", "height", self.height, "expects 0 .. 0.3 m, above 0")

    def heights(self) -> np.ndarray:
        """Compute the heights of the points over the lowest one, as shares of `height`.

        Returns:
            The shares [-], `(rows along y, columns along x)`.
        """
        at = np.linspace(-EDGE / 2, EDGE / 2, round(EDGE / CELL) + 1)
        heights = np.random.default_rng(self.seed).uniform(size=(len(at), len(at)))
        heights[0, 0], heights[-1, -1] = 0.0, 1.0  # MuJoCo stretches heights to 0 .. 1
        heights[np.ix_(np.abs(at) <= FLAT, np.abs(at) <= FLAT)] = 0.5
        return heights

    @override
    def shape(self, spec: mujoco.MjSpec) -> None:
        """Replace the plane by a height field under the same name."""
        import mujoco

        heights = self.heights()
        spec.add_hfield(
            name="uneven",
            nrow=heights.shape[0],
            ncol=heights.shape[1],
            size=[EDGE / 2, EDGE / 2, self.height, _THICK],
            userdata=heights.ravel().tolist(),
        )
        floor = spec.geom(FLOOR)
        floor.type = mujoco.mjtGeom.mjGEOM_HFIELD
        floor.hfieldname = "uneven"
        floor.pos = [0.0, 0.0, -self.height / 2]


class _Weaker(Live):
    def motor_torque(self, torque: np.ndarray, tick: Tick) -> np.ndarray:
        return torque * self.alteration.factor


@dataclass(frozen=True, eq=False)
class TorqueConstants(Alteration):
    """Motors whose torque constants are not what their drives take them for: all torques are off by
    the same factor.
    """

    factor: float
    """Torque at the rotor over what the drive takes itself to give [-]."""
    live = _Weaker

    def __post_init__(self) -> None:
        if not 0.1 <= self.factor <= 2.0:
            raise InputError("torque constants", "factor", self.factor, "expects 0.1 .. 2")
