"""Joints that move otherwise than their encoders tell: what sits on rotors does not see a joint
knock about in its play.

A joint that moves by s beyond what is told of it needs the torque M s'' more, M the inertia matrix:
in short knocks all joints show a column of M at once. What a motor, friction or a stop does to a
joint shows in that joint alone. So the residuals' direction tells a hidden motion from a hidden
torque, and whose it is. The size is that at which the catalogue's play, or spring, knocks as hard.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.placing import moved_joints
from hyperleg_design.gap.inference.detectors.heard import KNOCKING, Heard
from hyperleg_design.gap.inference.detectors.loose import LIKELIER, PLAY, SPRING, sided, valued
from hyperleg_design.gap.model import rigid
from hyperleg_design.gap.results.diagnosis import Named
from hyperleg_design.gap.signals.stamps import of_acceleration

if TYPE_CHECKING:
    from hyperleg_design.gap.signals.signals import Signals

LOWEST = 4.0
"""Of what counts as a knock [Hz]; below, joints move as commanded, and models err."""
HIGHEST = 0.3
"""Of it, over the log's rate."""
SLOWEST = 0.5
"""Of what sizes are told by [Hz]."""
EPISODE = 6.0
"""Residual over the robust scale of its row, above `LOWEST`, from which there is a knock; what
samples off their stamps make of it included."""
LEAST = 100
"""Ticks of knocks, of all logs, that must be seen."""
EXPLAINED = 0.5
"""Least share of the knocks' squares, each row over its scale, that the motion of one joint
explains; healthy robots show 0.3."""
BEYOND_ROW = 0.1
"""Of it, beyond the share that the row of any one joint has: that may be a torque."""
OF_REFERENCES = 0.6
"""Of the knocks' strength, at most that reference logs may show at the same joint: so healthy
joints knock, too."""
SLOWER, PADDED = 0.5, 50
"""`LOWEST` over the highest frequency that a log resolves, at most: 27 Hz at least; and ticks of a
log, at least."""
SHOWN = 0.6
"""For the eye [s]."""
ON_ROTORS = 1.0
"""Side of the encoders."""
SIZES, WIDEST = 25, 30.0
"""Sizes that are tried, and how far from the usual one."""
SPREAD = 2.5
"""Of sizes beyond those that strength and time of the knocks tell (assumed)."""


class _Knocks(NamedTuple):
    """Of one log, `k` ticks in knocks, `n` joints, `m` motors."""

    rows: np.ndarray
    """Residuals `(k, n)`, each over its scale."""
    explained: np.ndarray
    """Squares that a hidden motion of each motor's joints explains `(k, m)`."""
    torque: np.ndarray
    """Residuals `(k, n)` [Nm]."""
    ticks: int
    """Of the whole log."""


def knocking(
    signals: Sequence[Signals], references: Sequence[Signals] = (), known: Sequence[np.ndarray] = ()
) -> Heard | None:
    """The belt whose joints knock about where encoders do not see it; None where none does, and of
    robots that stand on their feet.

    Args:
        signals: logs to be diagnosed.
        references: logs of the healthy robot.
        known: what causes explain of each log's residual of motion `(t, n)` [Nm]; nothing by
            default.
    """
    if known:
        lefts = [
            {**one.residual, "motion": one.residual["motion"] - part}
            for one, part in zip(signals, known, strict=True)
        ]
        signals = [replace(one, residual=left) for one, left in zip(signals, lefts, strict=True)]
    subject = signals[0].subject
    if (
        subject.floating or len(subject.joints) < 2
    ):  # one joint alone has no other row to tell motion from torque by
        return None
    if any(
        LOWEST * one.step > SLOWER * HIGHEST or len(one.time) < PADDED
        for one in (*signals, *references)
    ):
        return None
    logs = [_knocks(one) for one in signals]
    if sum(len(one.rows) for one in logs) < LEAST:
        return None
    shares, of_rows = _shares(logs)
    motor = int(shares.argmax())
    if shares[motor] < EXPLAINED or shares[motor] < of_rows.max() + BEYOND_ROW:
        return None
    if references and _strength(
        [_knocks(one) for one in references], motor
    ) > OF_REFERENCES * _strength(logs, motor):
        return None
    place = subject.motors[motor]
    closed, *each = (
        float(1 - np.sqrt(1 - _shares(some)[0][motor]))
        for some in (logs, *([one] for one in logs if len(one.rows)))
    )
    torque = np.concatenate([one.torque for one in logs])
    missed = float(np.sqrt(np.mean(np.sum(torque**2, 1))))
    says = (
        f"knocks about: for {len(torque)} ticks its joints take torques ({missed:.2g} Nm, rms) in "
        f"the proportions of a motion of "
        f"{', '.join(moved_joints(subject, motor))} that no encoder tells; its belt has play or is "
        f"soft, and the encoders sit on the rotors"
    )
    causes = _causes(signals, place, closed)
    fair = shares / shares.sum()
    of_motors = dict(zip(subject.motors, fair.tolist(), strict=True))
    return Heard(
        place,
        KNOCKING,
        says,
        np.nan,
        missed,
        "Nm",
        closed,
        (min(each), max(each)),
        "motor",
        of_motors,
        causes,
    )


def struck(signals: Signals, motor: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where a log is hit hardest: time `(t,)` [s], what the residual of motion leaves there, and
    what of it is in the proportions of a motion of a motor's joints, `(t, n)` [Nm] both, between
    `LOWEST` and `HIGHEST`.
    """
    fast = _between(signals, signals.residual["motion"], LOWEST)
    scale = _scale(fast)
    subject = signals.subject
    (column,) = rigid.accelerating(
        subject,
        signals.position,
        [subject.motor_from_joint[subject.motors.index(motor)]],
        rotors=False,
    )
    column = column / scale
    size = np.einsum("tn,tn->t", column, fast / scale) / np.maximum(
        np.einsum("tn,tn->t", column, column), 1e-12
    )
    explained = size[:, None] * column * scale
    half = round(SHOWN / 2 / signals.step)
    hardest = np.where(signals.valid, np.sum((explained / scale) ** 2, 1), 0.0)
    middle = min(max(int(hardest.argmax()), half), len(fast) - 1 - half)
    part = slice(max(middle - half, 0), middle + half + 1)
    return signals.time[part], fast[part], explained[part]


def _knocks(signals: Signals) -> _Knocks:
    subject, fast = signals.subject, _between(signals, signals.residual["motion"], LOWEST)
    scale = _scale(fast)
    when = (np.abs(fast) > EPISODE * scale).any(1) & signals.valid
    when[when] = (np.abs(fast[when]) > EPISODE * np.hypot(scale, _shaken(signals, when))).any(1)
    position, fast = signals.position[when], fast[when]
    explained = np.zeros((len(fast), len(subject.motors)))
    for motor, column in enumerate(
        rigid.accelerating(subject, position, subject.motor_from_joint, rotors=False)
    ):
        column = column / scale
        explained[:, motor] = np.einsum("tn,tn->t", column, fast / scale) ** 2 / np.maximum(
            np.einsum("tn,tn->t", column, column), 1e-12
        )
    return _Knocks(fast / scale, explained, fast, int(signals.valid.sum()))


def _shaken(signals: Signals, when: np.ndarray) -> np.ndarray:
    """Torque of motion that is only samples off their stamps, standard deviation at some ticks `(k,
    n)` [Nm].
    """
    noise = of_acceleration(signals)[when]
    columns = rigid.accelerating(signals.subject, signals.position[when], np.eye(noise.shape[1]))
    return np.asarray(
        np.linalg.norm(
            [column * noise[:, joint, None] for joint, column in enumerate(columns)], axis=0
        )
    )


def _between(signals: Signals, values: np.ndarray, lowest: float) -> np.ndarray:
    """What is faster than some frequency [Hz], and slow enough to be no noise `(t, n)`."""
    from scipy.signal import butter, sosfiltfilt

    band = butter(2, [2 * lowest * signals.step, 2 * HIGHEST], "band", output="sos")
    return np.asarray(sosfiltfilt(band, np.nan_to_num(values), axis=0))


def _scale(values: np.ndarray) -> np.ndarray:
    """Robust standard deviation of rows `(n,)`."""
    return np.asarray(np.maximum(np.median(np.abs(values), 0) / 0.6745, 1e-9))


def _shares(logs: Sequence[_Knocks]) -> tuple[np.ndarray, np.ndarray]:
    """Of the knocks' squares: what each motor's hidden motion explains `(m,)`, and what each
    joint's row has `(n,)`.
    """
    rows, explained = (
        np.concatenate([getattr(one, name) for one in logs]) for name in ("rows", "explained")
    )
    whole = max(float(np.sum(rows**2)), 1e-300)
    return explained.sum(0) / whole, np.sum(rows**2, 0) / whole


def _strength(logs: Sequence[_Knocks], motor: int) -> float:
    """Mean square of what a motor's hidden motion explains, over all time."""
    return float(
        sum(one.explained[:, motor].sum() for one in logs) / sum(one.ticks for one in logs)
    )


def _causes(signals: Sequence[Signals], place: str, closed: float) -> tuple[Named, Named]:
    """Play and spring there; first the one whose knocks come when they do."""
    subject = signals[0].subject
    fitted = sorted(
        ((*_fitted(effect, signals, place), effect) for effect in (PLAY, SPRING)),
        key=lambda one: -one[1],
    )
    first, second = (
        Named(effect, place, share, closed, valued(effect, subject, place, size, side=ON_ROTORS))
        for (size, _, effect), share in zip(fitted, (LIKELIER, 1 - LIKELIER), strict=True)
    )
    return first, second


def _fitted(
    effect: str, signals: Sequence[Signals], place: str
) -> tuple[tuple[float, float, float], float]:
    """Size of an effect, with its interval, and how well what it leaves goes with what is seen,
    from -1 to 1.

    Ends are harder in the model than in gears, so that the size which knocks as hard is too small;
    the one whose knocks come when they do, if any does, is rather too large.
    """
    one, subject = EFFECTS[effect], signals[0].subject
    low, high = one.bounds(place, subject)
    usual = float(one.usual(place, subject)[0])
    sizes = np.unique(np.clip(np.geomspace(usual / WIDEST, usual * WIDEST, SIZES), low[0], high[0]))
    values = np.column_stack(
        [sizes, np.tile(sided(effect, subject, place, ON_ROTORS)[1:], (len(sizes), 1))]
    )
    strong, both, known = np.zeros(len(sizes)), np.zeros(len(sizes)), 0.0
    for log in signals:
        seen = _between(log, log.residual["motion"], SLOWEST)[log.valid]
        scale = _scale(seen)
        known += float(np.sum((seen / scale) ** 2))
        for k, trace in enumerate(one.trace(log, place, values)["motion"]):
            left = _between(log, trace, SLOWEST)[log.valid]
            strong[k] += float(np.sum((left / scale) ** 2))
            both[k] += float(np.sum(left * seen / scale**2))
    together = both / np.sqrt(np.maximum(strong * known, 1e-24))
    hard, timed = (
        float(sizes[np.argmin(np.abs(np.log(np.maximum(strong, 1e-12) / known)))]),
        float(sizes[np.argmax(together)]),
    )
    if together.max() <= 0:
        return (hard, hard / SPREAD, hard * WIDEST), float(together.max())
    return (
        float(np.sqrt(hard * timed)),
        min(hard, timed) / SPREAD,
        max(hard, timed) * SPREAD,
    ), float(together.max())
