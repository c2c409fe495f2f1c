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
"""Standard deviation of the parameters over their spread as nuisance parameters: a prior for those
that the logs do not show."""
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
    postures = [_posture_of(log_signals) for log_signals in signals]
    values = np.zeros(drives.count)
    history = []
    for _ in range(ROUNDS):
        slopes, errors = zip(
            *(
                _first_order(log_signals, drives, values, posture)
                for log_signals, posture in zip(signals, postures, strict=True)
            ),
            strict=True,
        )
        solution = _solved(np.concatenate(slopes), np.concatenate(errors), drives, values)
        change, values = np.abs(solution - values), solution
        history.append((time.perf_counter() - begun, values.copy()))
        if np.all(change < 0.1 * drives.spread):
            break
    rollouts = [Rollout(log_signals, drives) for log_signals in signals]
    # the start is the better of what the traces say and the model as it is
    tried = [(_cost(rollouts, start), start) for start in (values, np.zeros(drives.count))]
    cost, values = min(tried, key=lambda pair: pair[0])
    evaluations = len(tried)
    for _ in range(STEPS):
        slopes = [
            _first_order(log_signals, drives, values, posture)[0]
            for log_signals, posture in zip(signals, postures, strict=True)
        ]
        errors = [_known_error(rollout, values) for rollout in rollouts]
        goal = _solved(np.concatenate(slopes), np.concatenate(errors), drives, values)
        improved = False
        for share in (1.0, 0.4, 0.15):
            trial_values = values + share * (goal - values)
            reached = _cost(rollouts, trial_values)
            evaluations += 1
            if reached < cost:
                improved = cost - reached > ENOUGH * cost
                cost, values = reached, trial_values
                history.append((time.perf_counter() - begun, values.copy()))
                break
        if not improved:
            break
    return Fitted(
        "own", values, time.perf_counter() - begun, evaluations, tuple(history), "finished"
    )


def _cost(rollouts: Sequence[Rollout], values: np.ndarray) -> float:
    total = float(sum(np.sum(rollout.error(values) ** 2) for rollout in rollouts))
    return total if np.isfinite(total) else np.inf


def _known_error(rollout: Rollout, values: np.ndarray) -> np.ndarray:
    """Error of the blocks that `_first_order` takes, one after the other."""
    signals = rollout.signals
    whole = np.zeros_like(signals.position)
    whole[rollout.ticks] = rollout.error(values)
    return np.asarray(_blocks(signals, whole)[_known(signals)].ravel())


def _known(signals: Signals) -> np.ndarray:
    return np.asarray(
        _blocks(signals, (np.isfinite(residual_of(signals)).all(1) & signals.valid).astype(float))
        == 1
    )


def _first_order(
    signals: Signals, drives: DriveSet, values: np.ndarray, posture: _Posture
) -> tuple[np.ndarray, np.ndarray]:
    """Slope of the predicted position by each parameter, times the parameter's spread `(N, P)`, and
    the error left `(N,)` [rad].
    """
    columns, rest = _columns(signals, drives, values)
    stacked = np.concatenate([columns, rest[..., None]], -1)
    stacked[~np.isfinite(stacked)] = 0.0
    response = (
        closed_loop_of(signals, drives, values, posture)
        .response(_blocks(signals, stacked))[_known(signals)]
        .reshape(-1, drives.count + 1)
    )
    # a torque that the model lacks (a positive trace) holds the robot back: position falls behind
    # the prediction
    return -response[:, :-1], -response[:, -1]


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


def residual_of(signals: Signals) -> np.ndarray:
    """Compute the residual of motion that is fitted `(t, n)` [Nm], with the command as the torque,
    because replays follow targets.

    Args:
        signals: a conditioned log.

    Returns:
        The residual `(t, n)` [Nm].
    """
    if signals.measured is None:
        return signals.residual["motion"]
    assert signals.command is not None
    commanded = limited_torque(
        signals.subject, signals.command.copy(), signals.motor_speed, signals.voltage
    )
    return signals.residual["motion"] + applied(
        signals.subject.joint_from_motor, commanded - signals.believed
    )


def _columns(
    signals: Signals, drives: DriveSet, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Slope of the traces by each parameter, times the parameter's spread `(t, n, P)`, and the
    residual less the traces `(t, n)`.
    """
    subject = signals.subject
    joints = len(subject.joints)
    columns = np.zeros((*signals.velocity.shape, drives.count))
    rest = residual_of(signals) - drives.part(values, "armature") * signals.acceleration
    for joint, name in enumerate(subject.joints):
        columns[:, joint, joint] = drives.spread[joint] * signals.acceleration[:, joint]
        for kind, identifier in CATALOGUE.items():
            place = KINDS.index(kind) * joints + joint
            columns[..., place], trace = _sloped(
                signals, identifier, name, float(values[place]), float(drives.spread[place])
            )
            rest = rest - trace
    late, spread = float(values[-1]), float(drives.spread[-1])
    traces = _late_targets(signals, np.array([late + spread, late]))
    columns[..., -1] = traces[0] - traces[1]
    return columns, rest - traces[1]


def _late_targets(signals: Signals, delay: np.ndarray) -> np.ndarray:
    """Trace of late targets: the torque that controllers ask for with the targets of now, less that
    with late ones `(k, t, n)` [Nm].
    """
    assert signals.target is not None
    target = held(signals.target, signals.subject.default)
    now = np.stack([delayed(column, delay, signals.step) for column in target.T], -1)
    return np.nan_to_num(signals.subject.gains[:, 0]) * ~signals.subject.passive * (target - now)


def _sloped(
    signals: Signals, identifier: str, location: str, value: float, spread: float
) -> tuple[np.ndarray, np.ndarray]:
    """Slope over one spread of an effect's trace in the residual of motion, and that trace `(t, n)`
    each.
    """
    effect = EFFECTS[identifier]
    settings = np.repeat(effect.nulls[None], 2, 0)
    settings[:, 0] += [value + spread, value]
    traces = effect.trace(signals, location, settings).get(
        "motion", np.zeros((2, *signals.velocity.shape))
    )
    return traces[0] - traces[1], traces[1]
