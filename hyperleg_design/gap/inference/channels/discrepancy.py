"""Shapes of what a robot's model leaves of each residual channel: functions of its own state.

No shape holds what its residual is made of, a measured torque or the logged command of a control,
which would take every change of the robot along. Outside of the states that reference logs reached,
shapes keep their prior deviation, so that the predictive variance grows there.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects.unlisted.inputs import FAST, SLOW, SPEED
from hyperleg_design.gap.signals.inertial import sensed
from hyperleg_design.gap.signals.signals import OF_SENSORS, Signals
from hyperleg_design.gap.signals.sliding import sliding

ANGLE = 0.7
"""Length scale of angles in the random features [rad] (assumed); `SPEED` is that of speeds."""
NEIGHBOURS = 2
"""Joints of the same chain whose state a joint's shapes hold."""
SEED = 7
"""Of the random features, which are the same for every robot."""
MOTORS = ("drive", "control")
"""Residuals of motor torques, whose shapes are functions of what the motor is asked for and of its
speed."""


def shapes(signals: Signals, residual: str, column: int, waves: int) -> np.ndarray:
    """Shapes of one channel in one log, in arbitrary units.

    Args:
        signals: a conditioned log of t ticks.
        residual: kind of the channel's residual.
        column: of that residual.
        waves: random cosine features beside the named shapes.

    Returns:
        `(shapes, t)`, unknown ticks zero.
    """
    if residual == "motion":
        named, state = _of_joint(signals, column)
    elif residual in MOTORS and signals.command is not None:
        named, state = _of_motor(signals, column, load(signals, residual, column))
    elif residual in OF_SENSORS:
        return np.nan_to_num(_varying(signals, residual)).T
    else:
        named = [np.ones(len(signals.time)), *signals.velocity.T[: NEIGHBOURS + 1]]
        return np.nan_to_num(np.array(named))
    rng = np.random.default_rng(SEED)
    direction = rng.standard_normal((waves, 8))[:, : state.shape[1]]
    phase = rng.uniform(0.0, 2 * np.pi, waves)
    features = np.cos(np.nan_to_num(state) @ direction.T + phase)
    return np.nan_to_num(np.concatenate([np.array(named), features.T]))


def load(signals: Signals, residual: str, column: int) -> np.ndarray:
    """Compute the quantity whose size scales a channel's discrepancy: the torque or speed of which
    the residual is the unexplained part, from the model where possible.

    Args:
        signals: a conditioned log of t ticks.
        residual: kind of the channel's residual.
        column: of that residual.

    Returns:
        `(t,)`, in the residual's unit.
    """
    if residual == "motion":
        return np.asarray(signals.rigid[:, column])
    if residual in MOTORS and signals.command is not None:
        asked = signals.command[:, column]
        return asked if residual == "drive" else asked - signals.residual["control"][:, column]
    if residual == "transmission":
        return np.asarray((signals.velocity @ signals.subject.joint_from_motor)[:, column])
    if residual in OF_SENSORS:
        return _varying(signals, residual)[:, column]
    return np.asarray(signals.residual[residual][:, column])


def _varying(signals: Signals, sensor: str) -> np.ndarray:
    """What a sensor of the IMU feels beyond its mean `(t, 3)`."""
    felt = sensed(signals, sensor)
    return np.asarray(felt - felt.mean(0))


def _of_joint(signals: Signals, joint: int) -> tuple[list[np.ndarray], np.ndarray]:
    tree, torque = signals.subject.tree, signals.rigid
    angle, speed, acceleration = signals.position, signals.velocity, signals.acceleration
    way = sliding(signals)
    q, v, a, t, d = (x[:, joint] for x in (angle, speed, acceleration, torque, way))
    named = [np.ones_like(q), np.sin(q), np.cos(q), np.sin(2 * q), np.cos(2 * q)]
    named += [v, v * np.abs(v), d, d * np.sin(q), d * np.cos(q)]
    named += [d * np.exp(-((v / SLOW) ** 2)), d * np.exp(-((v / FAST) ** 2))]
    named += [t, t * np.abs(t), d * np.abs(t), np.gradient(t, signals.step), a]
    chained = [
        k
        for k in range(tree.count)
        if k != joint and (k in tree.chain(joint) or joint in tree.chain(k))
    ]
    near = sorted(chained, key=lambda k: (abs(k - joint), k))[:NEIGHBOURS]
    for k in near:
        named += [torque[:, k], acceleration[:, k], speed[:, k], way[:, k]]
        named += [np.sin(angle[:, k]), np.cos(angle[:, k])]
        named += [np.sin(q + angle[:, k]), np.cos(q + angle[:, k]), v * speed[:, k]]
    size = float(np.sqrt(np.nanmean(t**2))) or 1.0
    state = [q / ANGLE, v / SPEED, t / size, d, *(angle[:, k] / ANGLE for k in near)]
    return named, np.stack(state, -1)


def _of_motor(
    signals: Signals, motor: int, command: np.ndarray
) -> tuple[list[np.ndarray], np.ndarray]:
    speed = signals.velocity @ signals.subject.joint_from_motor[:, motor]
    way = np.sign(speed)
    named = [np.ones_like(command), command, command * np.abs(command)]
    named += [np.gradient(command, signals.step), speed, way]
    named += [np.abs(command) * way, command * np.abs(speed)]
    size = float(np.sqrt(np.nanmean(command**2))) or 1.0
    return named, np.stack([command / size, speed / SPEED, way], -1)
