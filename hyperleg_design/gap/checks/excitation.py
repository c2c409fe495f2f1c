"""Which effects of the catalogue a log can show, and why not the others: what moved, how fast,
under which load, what was measured.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.logs.sampling import quantum

if TYPE_CHECKING:
    from hyperleg_design.gap.logs.log import Log
    from hyperleg_design.gap.model.subject import Subject

MOVING = 0.05
"""Speed from which a joint counts as moving [rad/s]."""
REVERSALS = 4
"""That friction needs to be told from a constant torque."""
SPEED_SPREAD = 3.0
"""Fastest tenth over slowest tenth of the moving time, that tells viscous from Coulomb friction."""
SWING = 0.3
"""Range of a joint that changes what gravity asks of it [rad]."""
RESONANCE = 8.0
"""Content of the motion that tells elasticity from delay [Hz]."""
BANDWIDTH = 10.0
"""Content of the command that tells a motor's bandwidth from delay [Hz]."""
COMMAND = 0.5
"""Content of the command from which a delay shows [Hz]."""
SEGMENT = 16384
"""Most rows of which one spectrum is made."""
NOISE_MARGIN = 1.5
"""Times the power of noise that does not count as motion."""
WARMING, SAGGING = 10.0, 0.03
"""Rise of a motor's temperature [K], and spread of the voltage over its mean, that change torque
visibly."""


@dataclass(frozen=True)
class Excitation:
    """What a log can say of one effect."""

    effect: str
    """Its identifier."""
    shown: bool
    """Whether this log can show it anywhere."""
    where: tuple[str, ...]
    """Joints, motors, feet or sensors at which it can; empty where it sits at the robot as a
    whole."""
    why: str
    """What is there, or what is lacking."""


@dataclass(frozen=True, eq=False)
class _Motion:
    """Facts of each joint of a log, `(n,)`."""

    joints: np.ndarray
    reversals: np.ndarray
    spread: np.ndarray
    """Of speeds while moving [-]."""
    swing: np.ndarray
    """[rad]"""
    content: np.ndarray
    """Frequency below which 98 % of the speed's power lies [Hz]."""
    command: np.ndarray
    """The same of the targets or commands [Hz]; 0 where there are none."""
    slow: np.ndarray
    """Share of the moving time below a tenth of the top speed [-]."""
    torque: np.ndarray
    """Whether a torque, a current, or targets with gains tell the joint's torque."""
    measured: np.ndarray
    """Whether a torque or current was measured."""
    asked: np.ndarray
    """Whether targets with gains or torque commands are known."""


def excitation_of(log: Log, subject: Subject | None = None) -> tuple[Excitation, ...]:
    """What a log can say of each effect; with a coupled robot, motors count for all joints they
    move.
    """
    motion = _motion(log, subject)
    return tuple(rule(identifier, log, motion) for identifier, rule in RULES.items())


def _motion(log: Log, subject: Subject | None) -> _Motion:
    joints = list(log.joints)
    position = log.stack("position", joints)
    rate = 1 / log.step
    velocity = np.stack([_speed(log, joint) for joint in joints], -1)
    moving = np.abs(velocity) > MOVING
    reversals, spread, slow = np.zeros(len(joints)), np.zeros(len(joints)), np.zeros(len(joints))
    for i in range(len(joints)):
        signs = np.sign(velocity[moving[:, i], i])
        reversals[i] = np.count_nonzero(np.diff(signs))
        speeds = np.abs(velocity[moving[:, i], i])
        if len(speeds) > 10:
            spread[i] = np.percentile(speeds, 90) / max(np.percentile(speeds, 10), 1e-9)
            slow[i] = np.mean(speeds < 0.1 * speeds.max())
    coupled = subject is not None and tuple(subject.motors) != tuple(subject.joints)

    def anywhere(*kinds: str) -> np.ndarray:
        if coupled and any(log.has(kind, motor) for kind in kinds for motor in log.motors):
            return np.ones(len(joints), bool)
        return np.array([any(log.has(kind, joint) for kind in kinds) for joint in joints], bool)

    gains = log.metadata.gains or (
        dict(zip(subject.joints, subject.gains, strict=True)) if subject is not None else {}
    )
    with_gains = np.array(
        [
            log.has("position_target", j) and j in gains and np.isfinite(gains[j]).all()
            for j in joints
        ],
        bool,
    )
    measured = anywhere("joint_torque", "motor_torque", "motor_current")
    asked = with_gains | anywhere("motor_torque_command")
    commands = np.array([_content(_asked(log, joint), rate, noisy=False) for joint in joints])
    return _Motion(
        np.array(joints),
        reversals,
        spread,
        np.nanmax(position, 0) - np.nanmin(position, 0),
        np.array(
            [
                _content(position[:, i], rate) if moving[:, i].any() else 0.0
                for i in range(len(joints))
            ]
        ),
        commands,
        slow,
        measured | asked,
        measured,
        asked,
    )


def _asked(log: Log, joint: str) -> np.ndarray:
    for kind in ("position_target", "motor_torque_command"):
        if log.has(kind, joint):
            return log.column(f"{kind}/{joint}")
    return np.empty(0)


def _speed(log: Log, joint: str) -> np.ndarray:
    """Of a joint, smoothed over 25 ms, without the noise of differences [rad/s]."""
    width = max(1, round(0.025 / log.step))
    values = log.column(f"position/{joint}")
    known = np.isfinite(values)
    filled = (
        np.interp(log.time, log.time[known], values[known])
        if known.sum() > 1
        else np.zeros(len(values))
    )
    rate = np.gradient(filled, log.time)
    if width > 1 and len(rate) > 3 * width:
        rate = np.convolve(rate, np.ones(width) / width, mode="same")
    rate[~known] = 0.0
    return np.asarray(rate)


def _content(values: np.ndarray, rate: float, *, noisy: bool = True) -> float:
    """Highest frequency above which a signal's rate still holds 2 % of its power, and more than its
    noise can [Hz].

    Noise is white in the signal itself; its size is that of the top quarter of the spectrum, or of
    the quantisation.
    """
    step = quantum(values[np.isfinite(values)])
    rates = np.diff(values)
    rates = np.nan_to_num(rates - np.nanmean(rates)) if np.isfinite(rates).any() else np.zeros(0)
    if len(rates) < 32 or not rates.any():
        return 0.0
    length = min(len(rates), SEGMENT)
    window = np.hanning(length)
    segments = rates[: len(rates) // length * length].reshape(-1, length)
    power = np.mean([np.abs(np.fft.rfft(segment * window)) ** 2 for segment in segments], axis=0)
    frequency = np.fft.rfftfreq(length, 1 / rate)
    scale = 4 * np.sin(np.pi * frequency / rate) ** 2  # of a difference
    top = slice(3 * len(power) // 4, None)
    variance = max(
        float(np.median(power[top] / scale[top])) / np.log(2), step**2 / 12 * float(window @ window)
    )  # median of an exponential
    above = np.cumsum(power[::-1])[::-1]
    enough = np.flatnonzero(
        above >= max(0.02 * above[0], noisy * NOISE_MARGIN * variance * float(scale.sum()))
    )
    return float(frequency[enough[-1]]) if len(enough) else 0.0


Rule = Callable[[str, "Log", _Motion], Excitation]


def _of_joints(
    test: Callable[[_Motion], np.ndarray], good: str, lacking: str, *, torque: bool = True
) -> Rule:
    """A rule for what sits at joints: those that pass, of which the torque is known."""

    def rule(effect: str, log: Log, motion: _Motion) -> Excitation:
        if torque and not motion.torque.any():
            return Excitation(
                effect,
                False,
                (),
                "no torque, no current, and no targets with gains: forces are unknown",
            )
        passed = test(motion) & (motion.torque if torque else True)
        return Excitation(
            effect,
            bool(passed.any()),
            tuple(motion.joints[passed]),
            good if passed.any() else lacking,
        )

    return rule


def _of_drive(test: Callable[[_Motion], np.ndarray], good: str, lacking: str) -> Rule:
    """A rule for what needs command and measurement of the same motor to be told apart from
    mechanics.
    """

    def rule(effect: str, log: Log, motion: _Motion) -> Excitation:
        if not motion.asked.any():
            return Excitation(
                effect,
                False,
                (),
                "no targets with gains and no torque command: what was asked for is unknown",
            )
        passed = test(motion) & motion.asked
        both = (passed & motion.measured).any()
        text = (
            good if both else f"{good}; no measured torque or current, so only through the motion"
        )
        return Excitation(
            effect,
            bool(passed.any()),
            tuple(motion.joints[passed]),
            text if passed.any() else lacking,
        )

    return rule


def _torque_constant(effect: str, log: Log, motion: _Motion) -> Excitation:
    if not any(log.has("motor_current", m) or log.has("motor_torque", m) for m in log.motors):
        return Excitation(
            effect,
            False,
            (),
            "no current and no motor torque: not told from controller_gain or payload",
        )
    motors = tuple(
        m for m in log.motors if log.has("motor_current", m) or log.has("motor_torque", m)
    )
    moved = bool((motion.swing > SWING).any())
    return Excitation(
        effect,
        moved,
        motors if moved else (),
        "current or torque under a changing load" if moved else "the load hardly changes",
    )


def _by_speeds(otherwise: Rule) -> Rule:
    """A rule for what sits between motors and joints: speeds of both tell it, else another rule."""

    def rule(effect: str, log: Log, motion: _Motion) -> Excitation:
        motors = tuple(m for m in log.motors if log.has("motor_velocity", m))
        if motors and (motion.reversals > 0).any():
            return Excitation(effect, True, motors, "speeds of motors and joints")
        return otherwise(effect, log, motion)

    return rule


def _ratio_by_torque(effect: str, log: Log, motion: _Motion) -> Excitation:
    passed = motion.torque & (motion.swing > SWING)
    why = (
        "through the torques only: it looks like controller_gain"
        if passed.any()
        else "no motor speeds, and joints hardly move"
    )
    return Excitation(effect, bool(passed.any()), tuple(motion.joints[passed]), why)


def _thermal(effect: str, log: Log, motion: _Motion) -> Excitation:
    known = [m for m in log.motors if log.has("motor_temperature", m)]
    if not known:
        return Excitation(effect, False, (), "no motor temperature")
    rise = {
        m: float(
            np.nanmax(log.column(f"motor_temperature/{m}"))
            - np.nanmin(log.column(f"motor_temperature/{m}"))
        )
        for m in known
    }
    warm = tuple(m for m in known if rise[m] >= WARMING)
    why = f"temperature changes by {max(rise.values()):.0f} K"
    return Excitation(
        effect,
        bool(warm) and bool(motion.torque.any()),
        warm,
        why if warm else f"{why}; {WARMING:.0f} K are needed",
    )


def _voltage(effect: str, log: Log, motion: _Motion) -> Excitation:
    values = log.column("battery_voltage")
    if not np.isfinite(values).any():
        return Excitation(effect, False, (), "no battery voltage")
    following = log.metadata.supply
    if following and following.keys() >= set(log.motors or log.joints):
        return Excitation(
            effect,
            False,
            (),
            "all drives follow the logged voltage already, as declared by `supply`",
        )
    spread = float(
        (np.nanpercentile(values, 95) - np.nanpercentile(values, 5))
        / max(abs(np.nanmean(values)), 1e-9)
    )
    enough = spread >= SAGGING and bool(motion.torque.any())
    return Excitation(
        effect,
        enough,
        (),
        f"voltage varies by {100 * spread:.0f} %"
        + ("" if enough else f"; {100 * SAGGING:.0f} % are needed"),
    )


def _imu(effect: str, log: Log, motion: _Motion) -> Excitation:
    known = tuple(k for k in ("gyro", "accelerometer") if log.has(k, "x"))
    return Excitation(
        effect,
        bool(known),
        known,
        "inertial data" if known else "no gyroscope and no accelerometer",
    )


def _ground_friction(effect: str, log: Log, motion: _Motion) -> Excitation:
    feet = tuple(
        f
        for f in log.feet
        if log.has("contact_force", f"{f}_x") or log.has("contact_force", f"{f}_y")
    )
    return Excitation(
        effect,
        bool(feet),
        feet,
        "forces along the ground" if feet else "no contact forces along the ground",
    )


def _ground_compliance(effect: str, log: Log, motion: _Motion) -> Excitation:
    feet = tuple(f for f in log.feet if log.has("contact_force", f"{f}_z"))
    return Excitation(
        effect, bool(feet), feet, "vertical contact forces" if feet else "no contact forces"
    )


def _reversing(motion: _Motion) -> np.ndarray:
    return np.asarray(motion.reversals >= REVERSALS)


def _swinging(motion: _Motion) -> np.ndarray:
    return np.asarray(motion.swing > SWING)


_FEW = f"no joint reverses {REVERSALS} times"
_STILL = f"no joint swings by {SWING} rad"
RULES: dict[str, Rule] = {
    "coulomb_friction": _of_joints(_reversing, "motion reverses", _FEW),
    "viscous_friction": _of_joints(
        lambda m: _reversing(m) & (m.spread > SPEED_SPREAD),
        "speeds differ",
        "one speed only: viscous and Coulomb friction look alike",
    ),
    "stribeck_friction": _of_joints(
        lambda m: _reversing(m) & (m.slow > 0.05),
        "slow and fast motion",
        "no slow motion: breakaway is passed in a few ticks",
    ),
    "load_dependent_friction": _of_joints(
        lambda m: _reversing(m) & _swinging(m),
        "reverses under different loads",
        "no joint reverses under different loads",
    ),
    "torque_constant": _torque_constant,
    "torque_saturation": _of_drive(
        _swinging, "commands of different size", "commands hardly change"
    ),
    "thermal_derating": _thermal,
    "voltage_sag": _voltage,
    "command_delay": _of_drive(
        lambda m: m.command > COMMAND,
        "commands change fast enough",
        f"commands hold nothing above {COMMAND} Hz",
    ),
    "actuator_bandwidth": _of_drive(
        lambda m: m.command > BANDWIDTH,
        f"commands reach past {BANDWIDTH:.0f} Hz",
        f"commands hold nothing above {BANDWIDTH:.0f} Hz: looks like delay",
    ),
    "rotor_inertia": _of_joints(
        lambda m: _reversing(m) & (m.content > 1.0), "motion accelerates", "hardly any acceleration"
    ),
    "transmission_elasticity": _by_speeds(
        _of_joints(
            lambda m: m.content > RESONANCE,
            f"motion reaches past {RESONANCE:.0f} Hz",
            f"motion holds nothing above {RESONANCE:.0f} Hz: looks like delay",
        )
    ),
    "backlash": _by_speeds(_of_joints(_reversing, "motion reverses", _FEW)),
    "transmission_ratio": _by_speeds(_ratio_by_torque),
    "encoder_offset": _of_joints(_swinging, "several postures", _STILL),
    "controller_gain": _of_drive(_swinging, "targets, gains and motion", _STILL),
    "payload": _of_joints(_swinging, "several postures", _STILL),
    "link_mass": _of_joints(_swinging, "several postures", _STILL),
    "link_com": _of_joints(_swinging, "several postures", _STILL),
    "cogging": _of_joints(
        lambda m: _swinging(m) & (m.slow > 0.05),
        "slow motion over a range",
        "no slow motion over a range",
    ),
    "joint_spring": _of_joints(_swinging, "several postures", _STILL),
    "imu_bias": _imu,
    "ground_friction": _ground_friction,
    "ground_compliance": _ground_compliance,
}
"""By effect, in the catalogue's order."""
