"""What a residual may be when nothing is wrong: noise that a log shows by itself, and how well
models of robots are known anyhow.

Of each sample of `filtering`, as a standard deviation. Torque noise is the residual's own level
above its cutoff, taken as white; noise of accelerations is the smoother's, times the inertias by
which the accelerations of all joints load one, and larger where joints are fast, as far as the
samples scatter more there: what is stamped a moment early or late is off by its speed. Beyond
noise, drives and friction of a healthy robot are known to shares of their size (`NoiseRules`),
which `nuisance` cannot express.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects.strength import joint_strength, motor_strength
from hyperleg_design.gap.inference.rules import NoiseRules
from hyperleg_design.gap.inference.white_noise import white_density
from hyperleg_design.gap.model import rigid
from hyperleg_design.gap.model.friction import stop
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.filtering import Band, FilteredLog
from hyperleg_design.gap.signals.ground import footings
from hyperleg_design.gap.signals.signals import OF_SENSORS, Signals
from hyperleg_design.gap.signals.sliding import dry_friction_in
from hyperleg_design.memoized import memoized

FAST = 10.0
"""Speed that a motor is made for where nobody gives its limits [rad/s]; assumed."""
AT_MOST, ENOUGH = 1.5, 16
"""Noise over all that a band shows, at most, and samples that tell what it shows."""
POSTURE = 0.05
"""Time in which a posture, and its inertia, hardly changes [s] (assumed)."""
FEWEST = 64
"""Samples of a position that tell whether its noise goes with speed."""
WITHOUT_DRIVES = {"base": 100.0, "ground": 100.0, "gyro": 1.0, "accelerometer": 10.0}
"""What stands for the torque that a joint is made for in residuals that are of no drive [N, Nm,
rad/s, m/s^2]; assumed."""


def expected(filtered_log: FilteredLog, rules: NoiseRules) -> list[np.ndarray]:
    """Compute the standard deviation that each sample may have when nothing is wrong.

    Args:
        filtered_log: of one log.
        rules: shares of loads and friction that count as noise.

    Returns:
        For each row `(samples,)`, in the row's unit.
    """
    load, still = _loads(filtered_log)
    return [_row(filtered_log, row, load, still, rules) for row in range(len(filtered_log.rows))]


def _row(
    filtered_log: FilteredLog,
    row: int,
    load: dict[str, np.ndarray],
    still: dict[str, np.ndarray],
    rules: NoiseRules,
) -> np.ndarray:
    signals, place = filtered_log.signals, filtered_log.rows[row]
    moving = load[place.residual_name][:, place.column]
    constant = still[place.residual_name][place.column]
    residual = np.where(
        filtered_log.mask[row], signals.residual[place.residual_name][:, place.column], 0.0
    )
    if place.residual_name in OF_SENSORS:  # a constant error is no noise
        residual = np.where(
            filtered_log.mask[row], residual - residual[filtered_log.mask[row]].mean(), 0.0
        )
    density = _capped(
        filtered_log,
        row,
        residual,
        white_density(residual, filtered_log.mask[row], place.cutoff, signals.step),
    )
    samples = filtered_log.sample(row, np.nan_to_num(moving)[None])[0]
    level, _, _ = filtered_log.labels(row)
    whole = (
        np.sqrt(np.nanmean(np.where(filtered_log.mask[row], moving, np.nan) ** 2))
        if filtered_log.mask[row].any()
        else 0.0
    )
    turning = _turning(filtered_log, row, rules) if constant > 0 else np.zeros(len(signals.time))
    sinking = _smoothed(_sinking(filtered_log, row) ** 2, rules.near / signals.step)
    noise_level, start = np.empty(len(samples)), 0
    for band, white in zip(filtered_log.bands[row], density, strict=True):
        part = slice(start, start + len(band.used))
        start = part.stop
        local = _smoothed(
            samples[part] ** 2, band.count / (filtered_log.length * signals.step) * rules.near
        )
        noise = white * (band.high - band.low) + _at(
            _of_acceleration(filtered_log, row, band.low, band.high), band
        )
        share = rules.torque**2 * local + (rules.leak * whole) ** 2
        dry = ((rules.friction + rules.turning * _at(turning, band)) * constant) ** 2 / len(
            filtered_log.bands[row]
        )
        noise_level[part] = np.sqrt(
            noise
            + share
            + dry
            + _at(sinking, band)
            + (rules.rounding * _strength(filtered_log, row)) ** 2
        )
    assert len(level) == start
    return noise_level


def _sinking(filtered_log: FilteredLog, row: int) -> np.ndarray:
    """What the height of a foot leaves open of the ground's vertical force `(t,)` [N]; 0
    elsewhere.
    """
    place = filtered_log.rows[row]
    if place.residual_name != "ground" or place.column % 3 != 2:
        return np.zeros(len(filtered_log.signals.time))
    return np.nan_to_num(footings(filtered_log.signals)[place.column // 3].doubt())


def _turning(filtered_log: FilteredLog, row: int, rules: NoiseRules) -> np.ndarray:
    """How much of a joint's friction turns over at each tick, averaged around it `(t,)`."""
    signals, place = filtered_log.signals, filtered_log.rows[row]
    joint = place.column
    if place.residual_name == "drive":
        joint = signals.subject.main_joint(joint)
    part = 1 - stop(signals.position[:, joint], rules.turning_way) ** 2
    return _smoothed(part * filtered_log.mask[row], rules.turning_time / signals.step)


def _at(values: np.ndarray, band: Band) -> np.ndarray:
    """Values of ticks at the samples of a band."""
    place = np.minimum((band.used * (band.length / band.count)).astype(int), len(values) - 1)
    return np.asarray(values[place])


def _loads(filtered_log: FilteredLog) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """By residual: the quantity of which it is the unexplained part `(t, columns)`, and the dry
    friction of the joints `(columns,)`.
    """
    signals = filtered_log.signals
    subject = signals.subject
    moving: dict[str, np.ndarray] = {}
    still: dict[str, np.ndarray] = {}
    for residual_name, residual in signals.residual.items():
        still[residual_name] = dry_friction_in(signals, residual_name)
        if residual_name == "motion":
            moving[residual_name] = applied(subject.joint_from_motor, signals.believed)
        elif residual_name == "base" and signals.contact is not None:
            total = np.linalg.norm(np.nan_to_num(signals.contact).sum(1), axis=-1)
            moving[residual_name] = np.stack([total] * 3 + [0.2 * total] * 3, -1)
        elif residual_name == "ground" and signals.contact is not None:
            moving[residual_name] = np.repeat(np.linalg.norm(signals.contact, axis=-1), 3, axis=-1)
        elif residual_name in OF_SENSORS:
            moving[residual_name] = np.zeros_like(residual)
        elif residual_name == "transmission":
            moving[residual_name] = signals.velocity @ subject.joint_from_motor
        elif signals.command is not None and residual.shape[1] == signals.command.shape[1]:
            moving[residual_name] = signals.command
        else:
            moving[residual_name] = residual
    return moving, still


def _strength(filtered_log: FilteredLog, row: int) -> float:
    place, subject = filtered_log.rows[row], filtered_log.signals.subject
    if place.residual_name == "motion":
        return float(joint_strength(subject)[place.column])
    if place.residual_name in WITHOUT_DRIVES:
        return WITHOUT_DRIVES[place.residual_name]
    if place.residual_name == "transmission":
        fastest = float(subject.no_load_speed[place.column])
        return fastest if np.isfinite(fastest) else FAST
    return motor_strength(subject, place.column)


def _capped(filtered_log: FilteredLog, row: int, residual: np.ndarray, white: float) -> np.ndarray:
    """Density of white noise in each band `(bands,)`, no more than what that band, or a faster one,
    shows in all [unit^2/Hz].

    What knocks or rings at high frequencies is not white: it is no reason for noise at low ones.
    """
    samples, start = filtered_log.sample(row, residual[None])[0], 0
    densities = []
    for band in filtered_log.bands[row]:
        part = samples[start : start + len(band.used)]
        start += len(band.used)
        densities.append(
            AT_MOST * float(np.mean(part**2)) / (band.high - band.low)
            if len(part) >= ENOUGH
            else np.inf
        )
    return np.minimum.accumulate(np.r_[white, densities[::-1]])[:0:-1]


def _of_acceleration(filtered_log: FilteredLog, row: int, low: float, high: float) -> np.ndarray:
    """Variance in a band of the torque that noise of positions feigns at each tick, twice
    differentiated, below the smoother's crossover `(t,)`.
    """
    signals, place = filtered_log.signals, filtered_log.rows[row]
    variance = np.zeros(len(signals.time))
    if signals.noise is None:
        return variance
    square = _shaken(signals)
    turned = (2 * np.pi) ** 4 * (high**5 - low**5) / 5
    if place.residual_name == "drive" and signals.sensed_behind[place.column]:
        rotors = signals.subject.motor_from_joint[place.column] @ signals.subject.armature
        variance = turned * square @ rotors**2
    elif place.residual_name == "motion" and np.isfinite(signals.noise[place.column]):
        stiff = _feedback(filtered_log, row)
        own = inertias_at(signals, place.column)
        variance = (
            turned * np.sum(own**2 * square, -1) + stiff**2 * (high - low) * square[:, place.column]
        )
    return np.asarray(
        _smoothed(2 * signals.step * variance, 0.5 / (high - low) / signals.step)
    )  # as long as a sample of the band sees


@memoized
def _shaken(signals: Signals) -> np.ndarray:
    """Variance of the noise of positions at each tick `(t, n)` [rad^2]: clocks that jitter make
    more of it where joints are fast.

    Its mean is what smoothing found; that a share of it goes with the square of speed, what the
    samples show beside the smoothed motion.
    """
    assert signals.noise is not None
    level = np.nan_to_num(signals.noise)
    variance = np.broadcast_to(level**2, signals.position.shape).copy()
    raw = signals.log.stack("position", signals.subject.joints)
    for joint, samples in enumerate(raw.T):
        square = np.nan_to_num(signals.velocity[:, joint]) ** 2
        known = np.isfinite(samples)
        if known.sum() < FEWEST or not square.any():
            continue
        beside = (samples - np.interp(signals.log.time, signals.time, signals.position[:, joint]))[
            known
        ] ** 2
        speed = np.interp(signals.log.time[known], signals.time, square)
        share = _share(beside, speed / square.mean())
        variance[:, joint] *= 1 - share + share * square / square.mean()
    return variance


@memoized
def of_acceleration(filtered_log: FilteredLog, row: int) -> tuple[np.ndarray, np.ndarray]:
    """Compute the noise of a row that comes from noise of accelerations.

    Args:
        filtered_log: of one log.
        row: one of its rows.

    Returns:
        Its variance at each sample, in the row's unit squared, and the mean square of its angular
        frequency [1/s^2], `(samples,)` each.
    """
    bands = filtered_log.bands[row]
    if not bands:
        return np.zeros(0), np.zeros(0)
    feigned = [_at(_of_acceleration(filtered_log, row, b.low, b.high), b) for b in bands]
    rate = [
        np.full(
            len(b.used), (2 * np.pi) ** 2 * 5 / 7 * (b.high**7 - b.low**7) / (b.high**5 - b.low**5)
        )
        for b in bands
    ]
    return np.concatenate(feigned), np.concatenate(rate)


@memoized
def of_load(filtered_log: FilteredLog, row: int) -> np.ndarray:
    """Compute the noise of the needed torque, beside that of accelerations: what sensors of forces
    under the feet leave, and forces that change between two samples.

    Above its cutoff a residual and the needed torque hold noise alone. The less of it is in their
    sum, the torque of the drives, the more of it is in both.

    Args:
        filtered_log: of one log.
        row: one of its rows of motion.

    Returns:
        Variance of each sample of the row that such noise makes `(samples,)` [Nm^2].
    """
    signals, channel, mask = filtered_log.signals, filtered_log.rows[row], filtered_log.mask[row]
    residual, needed = (
        np.where(mask, np.nan_to_num(values[:, channel.column]), 0.0)
        for values in (signals.residual[channel.residual_name], signals.rigid)
    )
    own, its, both = (
        white_density(values, mask, channel.cutoff, signals.step)
        for values in (residual, needed, residual + needed)
    )
    if own <= 0 or not filtered_log.bands[row]:
        return np.zeros(filtered_log.count(row))
    shared = float(np.clip(0.5 * (own + its - both) / own, 0.0, 1.0))
    return np.concatenate(
        [
            np.full(len(band.used), shared * white * (band.high - band.low))
            for band, white in zip(
                filtered_log.bands[row],
                _capped(filtered_log, row, residual, own),
                strict=True,
            )
        ]
    )


def shaken_accelerations(signals: Signals, rng: np.random.Generator) -> np.ndarray:
    """Draw accelerations that noise of the positions feigns, below the smoother's crossover.

    Args:
        signals: a conditioned log, `t` ticks.
        rng: source of the noise.

    Returns:
        The accelerations `(t, n)` [rad/s^2].
    """
    if signals.noise is None or signals.bandwidth is None:
        return np.zeros_like(signals.acceleration)
    white = np.sqrt(_shaken(signals)) * rng.normal(size=signals.position.shape)
    frequency = np.fft.rfftfreq(len(white), signals.step)[:, None]
    passed = -((2 * np.pi * frequency) ** 2) * (frequency < np.nan_to_num(signals.bandwidth))
    return np.fft.irfft(passed * np.fft.rfft(white, axis=0), len(white), axis=0)


def _share(square: np.ndarray, speed: np.ndarray) -> float:
    """Share of squares `(s,)` that goes with those of speed over their mean `(s,)`, from 0 to 1, by
    least squares.
    """
    apart = speed - speed.mean()
    rise = float(apart @ square) / max(float(apart @ apart), 1e-300)
    return float(np.clip(rise * speed.mean() / max(float(square.mean()), 1e-300), 0.0, 1.0))


@memoized
def inertias(signals: Signals) -> np.ndarray:
    """Torque at each joint over the acceleration of each, rotors included, every `POSTURE` along a
    log `(n, p, n)` [kg m^2].
    """
    some = np.nan_to_num(signals.position[:: _every(signals)])
    columns = rigid.accelerating(signals.subject, some, np.eye(some.shape[1]))
    return np.stack(columns, -1).swapaxes(0, 1)


def inertias_at(signals: Signals, joint: int) -> np.ndarray:
    """Compute the torque at one joint over the acceleration of each.

    Args:
        signals: a conditioned log, `t` ticks.
        joint: index of the joint.

    Returns:
        At every tick `(t, n)` [kg m^2].
    """
    own = inertias(signals)[joint]
    if signals.behind_gears is not None and signals.behind_gears[joint]:
        own = own - signals.subject.armature[joint]
    return np.asarray(own[np.arange(len(signals.time)) // _every(signals)])


def _every(signals: Signals) -> int:
    return max(round(POSTURE / signals.step), 1)


def _feedback(filtered_log: FilteredLog, row: int) -> float:
    """Torque over noise of position where the torque is computed from the logged position
    [Nm/rad].
    """
    signals, place = filtered_log.signals, filtered_log.rows[row]
    gain = (
        float(signals.subject.gains[place.column, 0])
        if signals.measured is None and signals.target is not None
        else 0.0
    )
    return gain if np.isfinite(gain) else 0.0


def _smoothed(values: np.ndarray, width: float) -> np.ndarray:
    """Moving average that keeps the length."""
    reach = max(round(width), 1)
    total = np.concatenate([[0.0], np.cumsum(values)])
    index = np.arange(len(values))
    left, right = np.maximum(index - reach, 0), np.minimum(index + reach + 1, len(values))
    return np.asarray((total[right] - total[left]) / np.maximum(right - left, 1))
