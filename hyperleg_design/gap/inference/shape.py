"""Shapes of residuals that no effect of the catalogue has: how an unknown gap is told, and what the
report says of it.

Each shape is a block of smooth functions of what one row may depend on. They are fitted as ridge
regressions, beside the nuisance parameters and the causes found. One that closes more on held-out
data than the catalogue does speaks against the catalogue.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.effects.placing import motor_velocity
from hyperleg_design.gap.inference.nuisance import stop
from hyperleg_design.gap.signals.signals import OF_MOTORS
from hyperleg_design.gap.signals.sliding import sliding

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.base import Base
    from hyperleg_design.gap.inference.fit import Fit
    from hyperleg_design.gap.inference.samples import Samples
    from hyperleg_design.gap.signals.signals import Signals

PIECES = 8
"""Smooth functions over a range."""
STOPS = (0.01, 0.05, 0.2)
"""Ways over which a memory builds up [rad]."""
RIPPLES = (1, 2, 3, 4, 5, 6, 8, 10, 12)
"""Periods a turn of what varies with load and angle."""
WAVES = (1, 2, 3, 4)
"""Periods a turn of errors of an encoder."""
SMALL = 0.01
"""Offset at which its trace is taken [rad]."""
RHYTHMS = 3
"""Frequencies of a rhythm: the strongest and its multiples."""
FASTEST_RHYTHM = 8.0
"""[Hz]"""


@dataclass(frozen=True)
class Shape:
    """What one row of the residual may depend on."""

    name: str
    row: int
    """Of the samples' rows; -1 of all."""
    says: str
    """For people."""


OF_LOAD = "load_over_position"
"""Shape of a share of the torque that the motion needs."""
KINDS = {
    "position": "a torque that depends on the joint's position",
    "speed": "a torque that depends on the joint's speed, not in proportion",
    "friction_over_position": "friction that depends on where the joint is",
    "friction_over_time": "friction that changes with time",
    "time": "a torque that drifts with time",
    "memory": "a torque that depends on the way the joint came (hysteresis)",
    OF_LOAD: "a share of the load that varies with the joint's position",
    "other_joints": "a torque that depends on other joints' positions and speeds",
    "rhythm": "a torque that repeats in time, whatever the motion",
    "gravity": "gravity from another direction than the model's",
    "ratio_over_position": "a speed of the motor over its joints' that varies with their position",
    "encoder_over_position": "a position error that varies with the joint's position",
    "encoder_over_time": "a position error that drifts with time",
}


OF_ENCODER = ("encoder_over_position", "encoder_over_time")
"""Shapes of a position error, which moves the load of other joints too."""


def shapes(samples: Samples, rows: np.ndarray) -> list[Shape]:
    """Shapes that rows may have.

    Args:
        samples: of all logs.
        rows: that are looked at `(k,)`.
    """
    found = []
    for row in rows.tolist():
        one = samples.rows[row]
        if one.residual_name == "motion":
            kinds = [k for k in KINDS if k not in ("gravity", "ratio_over_position")]
        elif one.residual_name in ("drive", "control"):
            kinds = ["time", "rhythm", "speed", OF_LOAD]
        elif one.residual_name == "transmission":
            kinds = ["ratio_over_position"]
        else:
            kinds = ["time", "rhythm"]
        found += [Shape(kind, row, f"{one.name}: {KINDS[kind]}") for kind in kinds]
    if any(r.residual_name == "motion" for r in samples.rows):
        found.append(Shape("gravity", -1, KINDS["gravity"]))
    return found


def columns(base: Base, nothing: Fit, shape: Shape) -> np.ndarray | None:
    """Weighted columns of a shape `(k, S)`, each of the size of what is left in its row; None where
    it has none.
    """
    samples = base.samples
    if shape.row < 0:
        traces = samples.columns(_gravity, 3)
    else:
        one = samples.rows[shape.row]
        basis = _Basis(base, shape)
        count = basis.count
        if not count:
            return None

        def trace(signals: Signals) -> dict[str, np.ndarray]:
            if shape.name in OF_ENCODER:
                return basis.of_encoder(signals)
            values = basis.of(signals)
            if one.residual_name not in signals.residual:
                return {}
            full = np.zeros(
                (count, len(signals.time), signals.residual[one.residual_name].shape[1])
            )
            full[..., one.column] = values
            return {one.residual_name: full}

        traces = samples.columns(trace, count)
    if traces is None:
        return None
    weighted = traces * samples.weight
    level = float(np.sqrt(np.mean(nothing.rss)))
    norm = np.sqrt(
        (weighted**2).sum(1) / max(float(samples.share[np.any(weighted != 0, 0)].sum()), 1e-9)
    )
    kept = norm > 1e-9
    if not kept.any():
        return None
    size = (
        max(float(np.sqrt(np.max(nothing.scale[samples.group_row == shape.row], initial=0.0))), 1.0)
        if shape.row >= 0
        else max(level, 1.0)
    )
    return np.asarray(weighted[kept] / norm[kept, None] * size)


class _Basis:
    """Functions of one shape, with ranges taken from all logs."""

    def __init__(self, base: Base, shape: Shape) -> None:
        self.shape = shape
        samples = base.samples
        self.row = samples.rows[shape.row]
        logs = [s.signals for s in samples.filtered_logs]
        subject = logs[0].subject
        of_motor = self.row.residual_name in OF_MOTORS
        self.motor = (
            self.row.column
            if of_motor
            else int(np.argmax(np.abs(subject.joint_from_motor[self.row.column])))
            if self.row.residual_name == "motion"
            else 0
        )
        self.joint = (
            self.row.column
            if self.row.residual_name == "motion"
            else int(np.argmax(np.abs(subject.joint_from_motor[:, self.motor])))
        )
        position = np.concatenate([s.position[:, self.joint] for s in logs])
        self.low, self.high = np.percentile(position, [1, 99])
        speed = np.abs(np.concatenate([s.velocity[:, self.joint] for s in logs]))
        self.speed = max(float(np.percentile(speed, 95)), 1e-6)
        self.longest = max(float(s.time[-1] - s.time[0]) for s in logs)
        self.frequency = _rhythm(base, shape.row) if shape.name == "rhythm" else 0.0
        first = self.of(logs[0]) if self.high > self.low else np.zeros((0, 1))
        self.count = len(first)

    def of(self, signals: Signals) -> np.ndarray:
        """Functions at the ticks of a log `(k, t)`."""
        q, v = signals.position[:, self.joint], signals.velocity[:, self.joint]
        name = self.shape.name
        time = signals.time - signals.time[0]
        if name == "position":
            return self._pieces(q)
        if name == "speed":
            x = np.clip(v / self.speed, -2, 2)
            return np.stack([x * np.abs(x), x**3, np.tanh(3 * x), np.abs(x), x**2])
        if name == "friction_over_position":
            return self._pieces(q) * sliding(signals)[:, self.joint]
        if name == "friction_over_time":
            return (2 * time / self.longest - 1) ** np.arange(4)[:, None] * sliding(signals)[
                :, self.joint
            ]
        if name == "time":
            x = 2 * time / self.longest - 1
            return np.stack([x, x**2, x**3, (x - 0.3) * (x > 0.3), (x + 0.3) * (x < -0.3)])
        if name == "memory":
            return np.stack([stop(q, width) for width in STOPS])
        if name == OF_LOAD:
            # of the torque that the motion needs: of the measured one, its own errors would come
            # along
            needed = np.asarray(signals.rigid @ signals.subject.motor_from_joint.T)[:, self.motor]
            angle = signals.position @ signals.subject.joint_from_motor[:, self.motor]
            pieces = self._pieces(q)
            waves = np.concatenate(
                [[np.cos(k * angle), np.sin(k * angle)] for k in RIPPLES]
                + [pieces[1:] - pieces[:-1]]
            )
            return np.asarray(np.nan_to_num(needed) * waves)
        if name == "other_joints":
            others = [j for j in range(signals.position.shape[1]) if j != self.joint]
            return np.concatenate(
                [
                    signals.position[:, others].T - signals.subject.default[others, None],
                    signals.velocity[:, others].T,
                ]
            )
        if name == "rhythm":
            if not self.frequency:
                return np.zeros((0, len(time)))
            # the phase starts anew in every log
            return np.concatenate(
                [
                    [np.cos(w * time), np.sin(w * time)]
                    for w in 2 * np.pi * self.frequency * np.arange(1, RHYTHMS + 1)
                ]
            )
        if name == "ratio_over_position":
            return self._pieces(q) * motor_velocity(signals, self.motor)
        if name == "encoder_over_time":
            x = 2 * time / self.longest - 1
            return np.stack([x, x**2, x**3])
        if name == "encoder_over_position":
            angle = np.outer(WAVES, q)
            return np.concatenate([np.cos(angle), np.sin(angle)])
        return np.zeros((0, len(time)))

    def of_encoder(self, signals: Signals) -> dict[str, np.ndarray]:
        """Errors of a position that go with it as waves, or with time, in all residuals `(k, t,
        columns)` each.
        """
        from hyperleg_design.gap.effects import EFFECTS

        found = EFFECTS["encoder_offset"].trace(
            signals, signals.subject.joints[self.joint], np.array([[SMALL]])
        )
        return {
            residual_name: self.of(signals)[..., None] * (one[0] / SMALL)
            for residual_name, one in found.items()
        }

    def _pieces(self, position: np.ndarray) -> np.ndarray:
        """Overlapping bumps over the range of a joint `(PIECES, t)`."""
        place = (position - self.low) / max(self.high - self.low, 1e-9) * (PIECES - 1)
        return np.asarray(np.clip(1 - np.abs(place - np.arange(PIECES)[:, None]), 0, None))


def _rhythm(base: Base, row: int) -> float:
    """Strongest frequency in a row's residual beyond that of its motion [Hz], 0 where none stands
    out.
    """
    samples = base.samples
    one = samples.rows[row]
    total, frequency = None, None
    longest = max(len(s.signals.time) for s in samples.filtered_logs)
    for filtered_log in samples.filtered_logs:
        if one.residual_name not in filtered_log.signals.residual:
            continue
        values = np.nan_to_num(
            np.where(
                filtered_log.signals.valid,
                filtered_log.signals.residual[one.residual_name][:, one.column],
                0.0,
            )
        )
        power = (
            np.abs(np.fft.rfft(np.hanning(len(values)) * (values - values.mean()), 4 * longest))
            ** 2
        )
        total = power if total is None else total + power
        frequency = np.fft.rfftfreq(4 * longest, filtered_log.signals.step)
    if total is None or frequency is None:
        return 0.0
    inside = (frequency > 0.2) & (frequency < FASTEST_RHYTHM)
    return float(frequency[inside][np.argmax(total[inside])]) if inside.any() else 0.0


def _gravity(signals: Signals) -> dict[str, np.ndarray]:
    """Torque that gravity needs more when it points 0.01 further along each axis of the base `(3,
    t, n)`.
    """
    from hyperleg_design.gap.model import rigid

    subject = signals.subject
    found = np.zeros((3, *signals.position.shape))
    if subject.floating:
        return {}
    still = np.zeros_like(signals.position)
    import dataclasses

    here = rigid.inverse_dynamics(subject, signals.position, still, still, rotors=False)
    for axis in range(3):
        tilted = dataclasses.replace(
            subject, gravity=np.asarray(subject.gravity, float) + 0.1 * np.eye(3)[axis]
        )
        found[axis] = here - rigid.inverse_dynamics(
            tilted, signals.position, still, still, rotors=False
        )
    return {"motion": found}
