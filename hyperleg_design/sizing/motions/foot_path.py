"""Paths of a foot: it stands flat, rolls over its toes or its tip, swings, lands on its heel and
rolls flat.

The foot moves in its own sagittal plane. While it rolls, its place follows from its pitch alone: a
toe that moves lies flat and the foot turns about the toe's axis; a stiff foot rolls on the pads at
its tip; either rolls on its heel pads when it lands. Rolling pads do not slip. Pieces join with
equal position, rate and acceleration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.sizing.contacts import BALL, HEEL, TIP
from hyperleg_design.sizing.kinematics import has_toe_joint

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design

SWING, ON_HEEL, FLAT, ON_TOE = 0, 1, 2, 3
"""Phases of a foot."""
TOE_RETURN = 0.6
"""Part of the swing in which a bent toe straightens [-] (assumed)."""

_BEARS = {HEEL: (ON_HEEL, FLAT), BALL: (FLAT,), TIP: (FLAT, ON_TOE)}

State = tuple[float, float, float]
"""Value, rate, acceleration."""
REST: State = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class FootPath:
    """Motion of one foot over time, with rates and accelerations."""

    position: np.ndarray
    """Position of the ankle in the world, with rate and acceleration [m, m/s, m/s^2], `(3, n,
    3)`."""
    pitch: np.ndarray
    """Nose down, with rate and acceleration [rad, rad/s, rad/s^2], `(3, n)`."""
    toe: np.ndarray
    """Toe joint, with rate and acceleration, `(3, n)`; zero where the toe does not move."""
    phase: np.ndarray
    """Phase of the contact at each sample, `(n,)`."""

    def twist(self, order: int, sample: int) -> np.ndarray:
        """Compute the velocity or acceleration of the ankle and of the foot's turning at a sample.

        Args:
            order: 1 for velocity, 2 for acceleration.
            sample: its index.

        Returns:
            Linear, then angular part, in world axes, `(6,)`.
        """
        return np.array([*self.position[order, sample], 0.0, self.pitch[order, sample], 0.0])

    def bears(self, row: str) -> np.ndarray:
        """State when a row of pads may bear load.

        Args:
            row: `heel`, `ball` or `tip`.

        Returns:
            True where it may, `(n,)`.
        """
        return np.isin(self.phase, _BEARS[row])


@dataclass(frozen=True)
class Step:
    """One step of a foot: times of heel rise, toe-off, touchdown and flat foot, and where it
    goes.
    """

    rise: float
    """Heel leaves the floor [s]."""
    off: float
    """Foot leaves the floor [s]."""
    land: float
    """Foot meets the floor [s]."""
    flat: float
    """Foot is flat again [s]."""
    start: tuple[float, float, float]
    """Sole below the ankle, standing [m]."""
    end: tuple[float, float, float]
    """Position after the step [m]."""
    pitch_off: float
    """Nose down, when it leaves [rad]; 0 lifts it flat."""
    pitch_land: float
    """When it lands, negative for toes up [rad]; 0 lands it flat."""
    clearance: float
    """Added height in mid swing [m]."""


def quintic(time: np.ndarray, begin: float, end: float, first: State, last: State) -> np.ndarray:
    """Compute the polynomial of fifth degree between two states.

    Args:
        time: [s], `(n,)`.
        begin: time of the first state [s].
        end: time of the last state [s].
        first: value, rate and acceleration at the begin.
        last: value, rate and acceleration at the end.

    Returns:
        The polynomial with its rate and acceleration, `(3, n)`.
    """
    span = end - begin
    p0, v0, a0 = first[0], first[1] * span, first[2] * span**2
    p1, v1, a1 = last[0], last[1] * span, last[2] * span**2
    gap = p1 - p0 - v0 - a0 / 2
    slope, bend = v1 - v0 - a0, a1 - a0
    c3 = 10 * gap - 4 * slope + bend / 2
    c4 = -15 * gap + 7 * slope - bend
    c5 = 6 * gap - 3 * slope + bend / 2
    poly = np.polynomial.Polynomial([p0, v0, a0 / 2, c3, c4, c5])
    s = (time - begin) / span
    return np.stack([poly(s), poly.deriv(1)(s) / span, poly.deriv(2)(s) / span**2])


_RISE_AND_FALL = 64 * np.polynomial.Polynomial([0, 1, -1]) ** 3
_BUMP = (_RISE_AND_FALL, _RISE_AND_FALL.deriv(1), _RISE_AND_FALL.deriv(2))
"""`(4 s (1 - s))^3` with its rate and acceleration."""


def bump(time: np.ndarray, begin: float, end: float, height: float) -> np.ndarray:
    """Compute a smooth rise and fall, `height (4 s (1 - s))^3`, at rest at both ends.

    Args:
        time: [s], `(n,)`.
        begin: of the rise [s].
        end: of the fall [s].
        height: in the middle.

    Returns:
        The values with their rate and acceleration, `(3, n)`.
    """
    span = end - begin
    s = (time - begin) / span
    value, rate, bend = (poly(s) for poly in _BUMP)
    return height * np.stack([value, rate / span, bend / span**2])


def rolling(design: Design, row: str, pitch: np.ndarray) -> np.ndarray:
    """Ankle from its place when flat, while the foot rolls on a row of pads or about the toe axis.

    Args:
        design: a robot.
        row: `heel`, or `tip` for the toes: about the toe's axis where that moves, on the tip's pads
            otherwise.
        pitch: of the foot, with rate and acceleration, `(3, n)`.

    Returns:
        `(3, n, 2)`: x and z with rates and accelerations [m].
    """
    foot, radius = design.foot, float(design.contact.pad_radius)
    if row == HEEL:
        x, z, roll = -foot.heel_length + radius, -foot.ankle_height + radius, radius
    elif has_toe_joint(design):
        x, z, roll = foot.ball_length, -(foot.ankle_height - design.toe.axis_height), 0.0
    else:
        x, z, roll = (
            foot.ball_length + design.toe.length - radius,
            -foot.ankle_height + radius,
            radius,
        )
    angle, rate, turn = pitch
    cosine, sine = np.cos(angle), np.sin(angle)
    forward = np.stack(
        [x - (cosine * x + sine * z) + roll * angle, z - (-sine * x + cosine * z)], -1
    )
    slope = np.stack([sine * x - cosine * z + roll, cosine * x + sine * z], -1)
    bend = np.stack([cosine * x + sine * z, -sine * x + cosine * z], -1)
    return np.stack(
        [forward, slope * rate[:, None], slope * turn[:, None] + bend * (rate**2)[:, None]]
    )


def foot_path(design: Design, time: np.ndarray, steps: Sequence[Step]) -> FootPath:
    """Plan the path of a foot through its steps, in order of time; it stands where no step moves
    it.

    Args:
        design: a robot.
        time: [s], `(n,)`.
        steps: at least one.

    Returns:
        The path over time.
    """
    count, lift = len(time), np.array([0.0, 0.0, design.foot.ankle_height])
    position, pitch, toe = np.zeros((3, count, 3)), np.zeros((3, count)), np.zeros((3, count))
    phase = np.full(count, FLAT)
    position[0] = np.array(steps[0].start) + lift
    for step in steps:
        start, end = np.array(step.start) + lift, np.array(step.end) + lift
        off, land = _off_state(step), _land_state(step)

        rises = (time >= step.rise) & (time < step.off)
        if step.pitch_off:
            pitch[:, rises] = quintic(time[rises], step.rise, step.off, REST, off)
            phase[rises] = ON_TOE
            _place(position, rises, start, rolling(design, TIP, pitch[:, rises]))

        swings = (time >= step.off) & (time < step.land)
        phase[swings] = SWING
        pitch[:, swings] = quintic(time[swings], step.off, step.land, off, land)
        leaves = rolling(design, TIP, np.array(off)[:, None])[:, 0]
        meets = rolling(design, HEEL, np.array(land)[:, None])[:, 0]
        for axis, column in ((0, 0), (2, 1)):
            first = (start[axis] + leaves[0, column], leaves[1, column], leaves[2, column])
            last = (end[axis] + meets[0, column], meets[1, column], meets[2, column])
            position[:, swings, axis] = quintic(time[swings], step.off, step.land, first, last)
        position[:, swings, 1] = quintic(
            time[swings], step.off, step.land, (start[1], 0, 0), (end[1], 0, 0)
        )
        position[:, swings, 2] += bump(time[swings], step.off, step.land, step.clearance)

        lands = (time >= step.land) & (time < step.flat)
        if step.pitch_land:
            pitch[:, lands] = quintic(time[lands], step.land, step.flat, land, REST)
            phase[lands] = ON_HEEL
            _place(position, lands, end, rolling(design, HEEL, pitch[:, lands]))
        stands = time >= step.land if not step.pitch_land else time >= step.flat
        position[0, stands], position[1:, stands], pitch[:, stands] = end, 0.0, 0.0
        phase[stands] = FLAT

        if has_toe_joint(design) and step.pitch_off:
            back = step.off + TOE_RETURN * (step.land - step.off)
            straightens = (time >= step.off) & (time < back)
            toe[:, rises] = -pitch[:, rises]
            toe[:, straightens] = quintic(
                time[straightens], step.off, back, (-off[0], -off[1], -off[2]), REST
            )
    return FootPath(position, pitch, toe, phase)


def _place(position: np.ndarray, where: np.ndarray, base: np.ndarray, moved: np.ndarray) -> None:
    position[:, where, 0], position[:, where, 2] = moved[..., 0], moved[..., 1]
    position[1:, where, 1] = 0.0
    position[0, where] += np.array([base[0], 0.0, base[2]])
    position[0, where, 1] = base[1]


def _off_state(step: Step) -> State:
    """Pitch as the foot leaves: still turning, at the mean rate of the rise."""
    return (
        (step.pitch_off, step.pitch_off / (step.off - step.rise), 0.0) if step.pitch_off else REST
    )


def _land_state(step: Step) -> State:
    """Pitch as the foot lands: already turning, at the mean rate of the landing, so that the heel
    meets the floor without impact.
    """
    return (
        (step.pitch_land, -step.pitch_land / (step.flat - step.land), 0.0)
        if step.pitch_land
        else REST
    )
