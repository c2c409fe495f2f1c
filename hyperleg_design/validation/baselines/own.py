"""The diagnosis's own way to fit parameters, on the very parameters of `drive_set`: Gauss-Newton
whose slopes are traces.

Traces say what torque each parameter leaves in the residual of motion. What a replay of the whole
log would make of such a torque r is, to first order, the response e of the closed loop along the
logged motion,

    M(q) e'' + (D + friction slope) e' + (K + gravity slope) e = r,

so residual and traces both go through that response (`ClosedLoop`), and least squares then
minimises the position error that replays show. The first steps need no simulation at all; the last
ones take the error itself from one replay a step, where finite differences take one more for every
parameter.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.series import delayed
from hyperleg_design.gap.model import rigid
from hyperleg_design.gap.signals.channels import applied, held
from hyperleg_design.gap.signals.conditioning import limited_torque
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.validation.baselines.drive_set import KINDS, DriveSet, Fitted, check_logs
from hyperleg_design.validation.baselines.rollout import Rollout

ROUNDS = 1
"""Of linearising without replays."""
POSTURE_STEP = 0.02
"""Time between postures at which inertia and gravity's slope are taken [s]."""
BLOCK = 0.01
"""Over which torques and errors are averaged [s]: position loops of robots are slower."""
SLOPE = 1e-4
"""Of finite differences of gravity [rad]."""
STEPS, ENOUGH = 6, 1e-3
"""Steps with replays, and the least share of the squared error that a step must take off for
another one."""
WIDE = 50.0
"""Standard deviation of the parameters over their usual nuisance parameter: a prior for those that
the logs do not show."""
CATALOGUE = {
    "damping": "viscous_friction",
    "friction": "coulomb_friction",
    "bias": "encoder_offset",
}


@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """Response of a robot's closed loop along one log in steps of a block, by the trapezoidal rule
    (Newmark, 1/4 and 1/2).
    """

    step: float
    inverse: np.ndarray
    """Of M + h/2 D + h^2/4 K in each block `(b, n, n)`."""
    damping: np.ndarray
    """`(b, n)`"""
    stiffness: np.ndarray
    """`(b, n, n)`"""

    def response(self, torque: np.ndarray) -> np.ndarray:
        """Positions that torques `(b, n, k)` cause, from rest `(b, n, k)` [rad].

        Args:
            torque: `(b, n, k)` [Nm].

        Returns:
            The positions `(b, n, k)` [rad].
        """
        h = self.step
        position = np.zeros(torque.shape[1:])
        velocity, acceleration = np.zeros_like(position), np.zeros_like(position)
        out = np.empty_like(torque)
        for tick in range(len(torque)):
            ahead = position + h * velocity + h * h / 4 * acceleration
            faster = velocity + h / 2 * acceleration
            pulled = (
                torque[tick] - self.damping[tick][:, None] * faster - self.stiffness[tick] @ ahead
            )
            acceleration = self.inverse[tick] @ pulled
            position, velocity = ahead + h * h / 4 * acceleration, faster + h / 2 * acceleration
            out[tick] = position
        return out


@dataclass(frozen=True, eq=False)
class _Posture:
    """Inertia and gravity's slope along one log, by block of ticks `(b, n, n)` each."""

    inertia: np.ndarray
    slope: np.ndarray


def _posture_of(signals: Signals) -> _Posture:
    subject = signals.subject
    count = len(subject.joints)
    every = max(round(POSTURE_STEP / signals.step), 1)
    posture = signals.position[::every]
    still = np.zeros_like(posture)
    gravity = rigid.inverse_dynamics(subject, posture, still, still)
    inertia = np.empty((len(posture), count, count))
    slope = np.empty_like(inertia)
    for joint in range(count):
        unit = np.zeros(count)
        unit[joint] = 1.0
        inertia[:, :, joint] = (
            rigid.inverse_dynamics(subject, posture, still, still + unit) - gravity
        )
        slope[:, :, joint] = (
            rigid.inverse_dynamics(subject, posture + SLOPE * unit, still, still) - gravity
        ) / SLOPE
    of_block = (
        np.arange(len(signals.time) // _size(signals)) * _size(signals) + _size(signals) // 2
    ) // every
    return _Posture(inertia[of_block], slope[of_block])


def _size(signals: Signals) -> int:
    """Ticks of a block."""
    return max(round(BLOCK / signals.step), 1)


def _blocks(signals: Signals, values: np.ndarray) -> np.ndarray:
    """Means over blocks of ticks `(t, ...)`, `(blocks, ...)`."""
    size = _size(signals)
    count = len(values) // size
    return np.asarray(values[: count * size].reshape(count, size, *values.shape[1:]).mean(1))


def closed_loop_of(
    signals: Signals, drives: DriveSet, values: np.ndarray, posture: _Posture | None = None
) -> ClosedLoop:
    """Closed loop with some values of the parameters, linearised along a log.

    Args:
        signals: of a robot all of whose gains are known.
        drives: parameters of the robot.
        values: `(P,)`.
        posture: of an earlier call.
    """
    subject, h = signals.subject, signals.step * _size(signals)
    posture = posture or _posture_of(signals)
    gains = np.nan_to_num(subject.gains) * ~subject.passive[:, None]
    coulomb = np.maximum(subject.coulomb + drives.part(values, "friction"), 0.0)
    dry = (
        coulomb
        / subject.friction_speed
        / np.cosh(np.clip(_blocks(signals, signals.velocity) / subject.friction_speed, -30, 30))
        ** 2
    )
    damping = gains[:, 1] + np.maximum(subject.viscous + drives.part(values, "damping"), 0.0) + dry
    stiffness = posture.slope + np.diag(gains[:, 0] + subject.spring)
    eye = np.eye(len(subject.joints))
    inertia = posture.inertia + np.diag(
        np.maximum(drives.part(values, "armature"), -0.9 * np.diag(subject.armature))
    )
    whole = inertia + h / 2 * damping[:, :, None] * eye + h * h / 4 * stiffness
    return ClosedLoop(h, np.linalg.inv(whole), damping, stiffness)


def fit_own(signals: Sequence[Signals], drives: DriveSet) -> Fitted:
    """Fit the parameters to logs.

    Args:
        signals: conditioned logs with targets and gains, base fixed.
        drives: parameters of the robot.

    Raises:
        InputError: logs that the other methods cannot replay either.
    """
    check_logs(signals)
    begun = time.perf_counter()
    postures = [_posture_of(one) for one in signals]
    values = np.zeros(drives.count)
    history = []
    for _ in range(ROUNDS):
        slopes, errors = zip(
            *(
                _first_order(one, drives, values, posture)
                for one, posture in zip(signals, postures, strict=True)
            ),
            strict=True,
        )
        found = _solved(np.concatenate(slopes), np.concatenate(errors), drives, values)
        moved, values = np.abs(found - values), found
        history.append((time.perf_counter() - begun, values.copy()))
        if np.all(moved < 0.1 * drives.spread):
            break
    rollouts = [Rollout(one, drives) for one in signals]
    # the start is the better of what the traces say and the model as it is
    tried = [(_cost(rollouts, start), start) for start in (values, np.zeros(drives.count))]
    cost, values = min(tried, key=lambda pair: pair[0])
    evaluations = len(tried)
    for _ in range(STEPS):
        slopes = [
            _first_order(one, drives, values, posture)[0]
            for one, posture in zip(signals, postures, strict=True)
        ]
        errors = [_known_error(rollout, values) for rollout in rollouts]
        goal = _solved(np.concatenate(slopes), np.concatenate(errors), drives, values)
        bettered = False
        for share in (1.0, 0.4, 0.15):
            there = values + share * (goal - values)
            reached = _cost(rollouts, there)
            evaluations += 1
            if reached < cost:
                bettered = cost - reached > ENOUGH * cost
                cost, values = reached, there
                history.append((time.perf_counter() - begun, values.copy()))
                break
        if not bettered:
            break
    return Fitted(
        "own", values, time.perf_counter() - begun, evaluations, tuple(history), "finished"
    )


def _cost(rollouts: Sequence[Rollout], values: np.ndarray) -> float:
    total = float(sum(np.sum(rollout.error(values) ** 2) for rollout in rollouts))
    return total if np.isfinite(total) else np.inf


def _known_error(rollout: Rollout, values: np.ndarray) -> np.ndarray:
    """Error of the blocks that `_first_order` takes, one after the other."""
    one = rollout.signals
    whole = np.zeros_like(one.position)
    whole[rollout.ticks] = rollout.error(values)
    return np.asarray(_blocks(one, whole)[_known(one)].ravel())


def _known(one: Signals) -> np.ndarray:
    return np.asarray(
        _blocks(one, (np.isfinite(residual_of(one)).all(1) & one.valid).astype(float)) == 1
    )


def _first_order(
    one: Signals, drives: DriveSet, values: np.ndarray, posture: _Posture
) -> tuple[np.ndarray, np.ndarray]:
    """Slope of the predicted position by each parameter, in usual nuisance parameters `(N, P)`, and
    the error left `(N,)` [rad].
    """
    columns, rest = _columns(one, drives, values)
    stacked = np.concatenate([columns, rest[..., None]], -1)
    stacked[~np.isfinite(stacked)] = 0.0
    found = (
        closed_loop_of(one, drives, values, posture)
        .response(_blocks(one, stacked))[_known(one)]
        .reshape(-1, drives.count + 1)
    )
    # a torque that the model lacks (a positive trace) holds the robot back: position falls behind
    # the prediction
    return -found[:, :-1], -found[:, -1]


def _solved(
    slopes: np.ndarray, errors: np.ndarray, drives: DriveSet, values: np.ndarray
) -> np.ndarray:
    """Values of the least squares within the bounds, with a wide prior for what the logs do not
    show.
    """
    from scipy.optimize import lsq_linear

    gram, right = slopes.T @ slopes, slopes.T @ errors
    noise = max(
        float(errors @ errors - right @ np.linalg.lstsq(gram, right, rcond=1e-9)[0]),
        1e-6 * float(errors @ errors),
    ) / len(errors)
    whole = gram + (noise / WIDE**2 + 1e-12 * np.trace(gram) / drives.count) * np.eye(drives.count)
    root = np.linalg.cholesky(whole)
    low, high = (drives.low - values) / drives.spread, (drives.high - values) / drives.spread
    step = lsq_linear(root.T, np.linalg.solve(root, right), bounds=(low - 1e-9, high + 1e-9)).x
    return np.asarray(np.clip(values + step * drives.spread, drives.low, drives.high))


def residual_of(one: Signals) -> np.ndarray:
    """Residual that is fitted: of motion, with the command as the torque, as replays of targets
    have it `(t, n)` [Nm].

    Args:
        one: a conditioned log.

    Returns:
        The residual `(t, n)` [Nm].
    """
    if one.measured is None:
        return one.residual["motion"]
    assert one.command is not None
    commanded = limited_torque(one.subject, one.command.copy(), one.motor_speed, one.voltage)
    return one.residual["motion"] + applied(one.subject.joint_from_motor, commanded - one.believed)


def _columns(one: Signals, drives: DriveSet, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Slope of the traces by each parameter, in usual nuisance parameters `(t, n, P)`, and the
    residual less the traces `(t, n)`.
    """
    subject = one.subject
    joints = len(subject.joints)
    columns = np.zeros((*one.velocity.shape, drives.count))
    rest = residual_of(one) - drives.part(values, "armature") * one.acceleration
    for joint, name in enumerate(subject.joints):
        columns[:, joint, joint] = drives.spread[joint] * one.acceleration[:, joint]
        for kind, identifier in CATALOGUE.items():
            place = KINDS.index(kind) * joints + joint
            columns[..., place], trace = _sloped(
                one, identifier, name, float(values[place]), float(drives.spread[place])
            )
            rest = rest - trace
    late, spread = float(values[-1]), float(drives.spread[-1])
    found = _late_targets(one, np.array([late + spread, late]))
    columns[..., -1] = found[0] - found[1]
    return columns, rest - found[1]


def _late_targets(one: Signals, delay: np.ndarray) -> np.ndarray:
    """Trace of targets that come late: what the controller would ask for now, less what it asks for
    `(k, t, n)` [Nm].
    """
    assert one.target is not None
    assert one.target is not None
    target = held(one.target, one.subject.default)
    now = np.stack([delayed(column, delay, one.step) for column in target.T], -1)
    return np.nan_to_num(one.subject.gains[:, 0]) * ~one.subject.passive * (target - now)


def _sloped(
    one: Signals, identifier: str, location: str, value: float, spread: float
) -> tuple[np.ndarray, np.ndarray]:
    """Slope over one spread of an effect's trace in the residual of motion, and that trace `(t, n)`
    each.
    """
    effect = EFFECTS[identifier]
    settings = np.repeat(effect.nulls[None], 2, 0)
    settings[:, 0] += [value + spread, value]
    found = effect.trace(one, location, settings).get("motion", np.zeros((2, *one.velocity.shape)))
    return found[0] - found[1], found[1]
