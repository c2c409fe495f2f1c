"""A pelvis path that keeps the centre of pressure where it was planned.

For a body whose mass sits at height h, the zero-moment point is `x - (h / g) x''`. In a Fourier
series that is a factor `1 + (h / g) w^2` a harmonic, so the path for a wanted zero-moment point is
one division. The robot's legs weigh something: the zero-moment point of the whole robot (inverse
dynamics) misses the plan by an error, the same division turns the error into a correction of the
pelvis, and a few rounds bring it to nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InfeasibleError
from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.robot.names import SIDES
from hyperleg_design.sizing.kinematics import about_x, hip_center, leg_reach
from hyperleg_design.sizing.motions.foot_path import FootPath
from hyperleg_design.sizing.motions.motion import (
    PelvisPath,
    check_ranges,
    ground_wrench,
    joint_states,
    zero_moment_offset,
)

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.models import RigidBodyModel

TOLERANCE = 5e-4
"""Largest distance between planned and actual zero-moment point [m], but for the highest harmonic
of an even grid."""
LOAD_TOLERANCE = 0.02
"""Largest difference between planned and actual vertical force, over weight [-]."""
ROUNDS = 60
"""Corrections after which a plan counts as one that no pelvis path follows."""


@dataclass(frozen=True)
class Series:
    """Evenly sampled functions of time as Fourier series, to differentiate and filter.

    A motion that does not repeat runs forward and back: its mirror image makes it periodic, with
    zero rate at both ends.
    """

    time_step: float
    """Time between two samples [s]."""
    mirrored: bool

    def _spectrum(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        whole = np.concatenate([values, values[-2:0:-1]]) if self.mirrored else values
        frequency = 2 * np.pi * np.fft.rfftfreq(len(whole), self.time_step)
        spectrum = np.fft.rfft(whole, axis=0)
        if len(whole) % 2 == 0:
            spectrum[-1] = 0.0  # the highest harmonic has no derivative on this grid
        return spectrum, frequency.reshape(-1, *([1] * (values.ndim - 1)))

    def filtered(self, values: np.ndarray, lag: float) -> np.ndarray:
        """Solve `y - lag^2 y'' = values` for y.

        Args:
            values: over time, `(n, ...)`.
            lag: [s].

        Returns:
            y, `(n, ...)`.
        """
        spectrum, frequency = self._spectrum(values)
        return self._back(spectrum / (1 + (lag * frequency) ** 2), values)

    def derivatives(self, values: np.ndarray) -> np.ndarray:
        """Differentiate values over time.

        Args:
            values: over time, `(n, ...)`.

        Returns:
            Values without their highest harmonic, their rate and their acceleration, `(3, n, ...)`.
        """
        spectrum, frequency = self._spectrum(values)
        return np.stack(
            [
                self._back(spectrum * factor, values)
                for factor in (1.0 + 0 * frequency, 1j * frequency, -(frequency**2))
            ]
        )

    def integrated_twice(self, values: np.ndarray) -> np.ndarray:
        """Integrate values twice over time.

        Args:
            values: over time, `(n, ...)`.

        Returns:
            The function of zero mean whose acceleration is `values` minus their mean, `(n, ...)`.
        """
        spectrum, frequency = self._spectrum(values)
        integral = np.zeros_like(spectrum)
        integral[1:] = spectrum[1:] / (1j * frequency[1:]) ** 2
        return self._back(integral, values)

    def _back(self, spectrum: np.ndarray, values: np.ndarray) -> np.ndarray:
        count = 2 * (len(values) - 1) if self.mirrored else len(values)
        return np.asarray(np.fft.irfft(spectrum, count, axis=0)[: len(values)])


@dataclass(frozen=True, eq=False)
class Balanced:
    """A motion whose centre of pressure is where it was planned."""

    pelvis: PelvisPath
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    rounds: int


def highest_pelvis(
    design: Design,
    place: np.ndarray,
    feet: tuple[FootPath, FootPath],
    rise: np.ndarray,
    min_knee: float,
    roll: np.ndarray | float = 0.0,
) -> float:
    """Find the largest height to which `rise` can be added while no knee is straighter than
    `min_knee`.

    Args:
        design: a robot.
        place: of the pelvis, `(n, 2)` [m].
        feet: planned feet.
        rise: of the pelvis over time, `(n,)` [m].
        min_knee: [rad]
        roll: of the pelvis, `(n,)` [rad].

    Returns:
        The height [m].

    Raises:
        InfeasibleError: a foot is further away than the leg is long.
    """
    reach = leg_reach(design, min_knee)
    allowed = np.inf
    for side, path in zip(SIDES, feet, strict=True):
        hip = np.einsum("...ij,j->...i", about_x(np.asarray(roll)), hip_center(design, side))
        offset = path.position[0, :, :2] - place - hip[..., :2]
        room = reach**2 - np.sum(offset**2, -1)
        if np.any(room <= 0):
            far = float(np.sqrt(np.max(np.sum(offset**2, -1))))
            raise InfeasibleError(
                f"{design.name}: a foot would have to be {far:.3f} m off below the hip; the leg "
                f"allows {reach:.3f} m"
            )
        allowed = min(
            allowed, float(np.min(path.position[0, :, 2] + np.sqrt(room) - rise - hip[..., 2]))
        )
    return allowed


def lifted(
    design: Design,
    place: np.ndarray,
    feet: tuple[FootPath, FootPath],
    rise: np.ndarray,
    min_knee: float,
    roll: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Lift the path of a pelvis to the largest height that `highest_pelvis` allows.

    Args:
        design: a robot.
        place: of the pelvis, `(n, 2)` [m].
        feet: planned feet.
        rise: of the pelvis, with two derivatives by time, `(3, n)` [m, m/s, m/s^2].
        min_knee: [rad]
        roll: of the pelvis, `(n,)` [rad].

    Returns:
        Height of the pelvis with its derivatives, `(3, n)` [m, m/s, m/s^2].
    """
    height = highest_pelvis(design, place, feet, rise[0], min_knee, roll)
    return rise + np.array([[height], [0.0], [0.0]])


def balanced_states(
    model: RigidBodyModel,
    feet: tuple[FootPath, FootPath],
    pressure: np.ndarray,
    height: Callable[[np.ndarray, np.ndarray], np.ndarray],
    series: Series,
    drift: np.ndarray | None = None,
    load: np.ndarray | None = None,
    roll: np.ndarray | None = None,
) -> Balanced:
    """Find states that carry the feet along their paths with the zero-moment point at `pressure`.

    Args:
        model: floating robot.
        feet: planned feet.
        pressure: planned centre of pressure [m], `(n, 3)`.
        height: of the pelvis with rate and acceleration, `(3, n)`, over its horizontal place `(n,
            2)` and over the rise and fall that `load` asks for, `(3, n)`.
        series: how the motion repeats.
        drift: place, rate and acceleration [m] of a steady travel, `(3, n, 2)`, taken out before
            the Fourier series.
        load: planned vertical force over weight, `(n,)`, of mean 1; none leaves the height as it
            is.
        roll: of the pelvis with rate and acceleration [rad], `(3, n)`; none keeps it upright.

    Returns:
        The path of the pelvis, the states over time, and the number of rounds of correction.

    Raises:
        InfeasibleError: a leg does not reach, a joint leaves its range, or the corrections do not
        settle.
    """
    count = len(pressure)
    travel = np.zeros((3, count, 2)) if drift is None else drift
    center = model.center_of_mass(model.neutral())[2]
    mass = model.tree.mass
    weight, lag = GRAVITY * mass, np.sqrt(center / GRAVITY)
    sideways = series.filtered(pressure[:, :2] - travel[0], lag)
    rise = np.zeros(count) if load is None else series.integrated_twice(GRAVITY * (load - 1))
    lean = np.zeros((3, count)) if roll is None else roll
    miss = np.inf
    for done in range(1, ROUNDS + 1):
        plane = series.derivatives(sideways) + travel
        raised = height(plane[0], series.derivatives(rise))
        pelvis = PelvisPath(
            np.concatenate([plane, raised[..., None]], -1), np.zeros((3, count)), lean
        )
        q, v, a = joint_states(model, pelvis, feet)
        force, moment = ground_wrench(model, q, v, a)
        error = zero_moment_offset(force, moment, pressure)
        excess = np.zeros(count) if load is None else force[:, 2] / weight - load
        miss = float(np.max(np.abs(series.derivatives(error)[0])))
        if miss < TOLERANCE and np.max(np.abs(excess)) < LOAD_TOLERANCE:
            check_ranges(model, q)
            return Balanced(pelvis, q, v, a, done)
        # weighted by the load, the error is the moment over the weight, in which the pelvis's
        # acceleration is linear
        sideways = sideways - series.filtered(error * force[:, 2:] / weight, lag)
        rise = rise - series.integrated_twice(GRAVITY * excess)
    raise InfeasibleError(
        f"{model.design.name}: no pelvis path found that keeps the centre of pressure as planned; "
        f"it still misses by {miss:.4f} m; "
        "bend the knees more, move more slowly, or take more samples, an odd number"
    )
