"""How large a gap is, by the plainest means: what a log's torques leave over against the data
sheet's inverse dynamics.

Only sizes the cases of a trial; the diagnosis has its own, better ways.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.validation.blind.robots.chain import Chain

CUTOFF = 12.0
"""Of the low-pass on both sides of the residual [Hz]."""
SOFT = 0.03
"""Speed below which Coulomb friction is no sign yet [rad/s]."""
SLOW = 0.05
"""Speed below which a joint may stick [rad/s]."""
STICKING = 0.02
"""Time around such a moment that is left out too [s]."""
EDGE = 0.4
"""Left out at either end [s]."""


def residual(log: Log, chain: Chain) -> np.ndarray:
    """What nominal model and drives leave over `(t, n)` or `(t, n + m)` [Nm], filtered, without the
    ends; NaN where a joint may stick.

    Motion: believed joint torque less what the logged motion needs; drives, where torques are
    measured: measured motor torque less what targets and gains ask for.

    Args:
        log: the log.
        chain: the nominal robot.

    Returns:
        The residual `(t, n)` or `(t, n + m)` [Nm].
    """
    import pinocchio as pin
    from scipy.ndimage import minimum_filter1d
    from scipy.signal import butter, sosfiltfilt

    step = float(np.median(np.diff(log.time)))
    time = np.arange(log.time[0], log.time[-1], step)
    sos = butter(2, min(CUTOFF * 2 * step, 0.8), output="sos")

    def even(kind: str, names: tuple[str, ...]) -> np.ndarray:
        values = log.stack(kind, names)
        return np.stack([np.interp(time, log.time, column) for column in values.T], -1)

    def smooth(values: np.ndarray) -> np.ndarray:
        return sosfiltfilt(sos, values, axis=0)

    joints, motors = chain.joints, chain.motors
    raw = even("position", joints)
    position = smooth(raw)
    velocity = smooth(np.gradient(position, step, axis=0))
    acceleration = smooth(np.gradient(velocity, step, axis=0))
    speed = even("velocity", joints) if log.has("velocity", joints[0]) else velocity
    asked = chain.stiffness * (even("position_target", joints) - raw) - chain.damping * speed
    command = asked @ np.linalg.pinv(chain.joint_from_motor).T
    measured = None
    if log.has("motor_current", motors[0]):
        measured = even("motor_current", motors) * chain.torque_constant
    elif log.has("motor_torque", motors[0]):
        measured = even("motor_torque", motors)
    believed = (
        np.clip(command, -chain.peak_torque, chain.peak_torque) if measured is None else measured
    )
    model = chain.pinocchio()
    data = model.createData()
    needed = np.stack(
        [
            pin.rnea(model, data, q, v, a)
            for q, v, a in zip(position, velocity, acceleration, strict=True)
        ]
    )
    needed += acceleration @ (
        chain.joint_from_motor * chain.rotor_inertia @ chain.joint_from_motor.T
    )
    needed += chain.coulomb * np.tanh(velocity / SOFT) + chain.viscous * velocity
    motion = smooth(believed @ chain.joint_from_motor.T - needed)
    # A joint that sticks holds any torque up to its friction: no residual there.
    slow = minimum_filter1d(np.abs(velocity), 2 * round(STICKING / step) + 1, axis=0) < SLOW
    rows = [np.where(slow & (chain.coulomb > 0), np.nan, motion)]
    if measured is not None:
        rows.append(smooth(measured - command))
    cut = round(EDGE / step)
    return np.concatenate(rows, -1)[cut:-cut]


def multiple(with_effect: list[np.ndarray], clean: list[np.ndarray]) -> float:
    """Largest ratio over the rows of the effect's share to the clean log's residual, root mean
    square each, of a case's logs.

    Args:
        with_effect: residuals of the logs with the effect `(t, rows)`.
        clean: residuals of the same runs without it `(t, rows)`.

    Returns:
        The ratio [-].
    """
    difference = np.concatenate([a - b for a, b in zip(with_effect, clean, strict=True)])
    floor = np.concatenate(clean)
    enough = np.isfinite(difference).mean(0) > 0.02
    ratio = rms(difference) / np.maximum(rms(floor), 1e-9)
    return float(np.max(ratio[enough], initial=0.0))


def rms(values: np.ndarray) -> np.ndarray:
    """Root mean square over the rows `(columns,)`; NaN are left out.

    Args:
        values: `(rows, columns)`.

    Returns:
        `(columns,)`.
    """
    known = np.isfinite(values)
    return np.sqrt((np.where(known, values, 0.0) ** 2).sum(0) / np.maximum(known.sum(0), 1))
