"""Smooth functions of what the torque at a joint may depend on.

None of them is the trace of an effect of the catalogue: constant, slope, sign and proportion are
left out, as is a pure wave of the motor's angle.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from hyperleg_design.gap.model.friction import stop
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import sliding
from hyperleg_design.memoized import memoized

SHAPES = 8
"""Most functions of one input."""
WAVES = (1.0, 2.0, 4.0, 8.0)
"""Wave numbers of functions of an angle, in octaves [1/rad] (assumed)."""
SPEED = 2.0
"""Scale of speeds [rad/s] (assumed)."""
SLOW, FAST = 0.3, 2.0
"""Speeds over which what is there at rest fades [rad/s] (assumed)."""
WAYS = (0.02, 0.05, 0.15, 0.4)
"""Half of the ways over which a torque with hysteresis reverses [rad] (assumed)."""


@memoized
def functions(signals: Signals, joint: int, name: str) -> np.ndarray:
    """Functions of one input, each of the order of 1.

    Args:
        signals: a conditioned log, `t` ticks.
        joint: index of the joint.
        name: one of `INPUTS`.

    Returns:
        `(k, t)`, no more than `SHAPES`; unknown ticks zero.
    """
    shapes = np.array(_FUNCTIONS[name][1](signals, joint)).reshape(-1, len(signals.time))
    return np.nan_to_num(shapes)


def _angle(signals: Signals, joint: int) -> np.ndarray:
    return np.asarray(signals.position[:, joint] - signals.subject.default[joint])


def _waves(angle: np.ndarray) -> list[np.ndarray]:
    return [wave(k * angle) for k in WAVES for wave in (np.cos, np.sin)]


def _of_position(signals: Signals, joint: int) -> list[np.ndarray]:
    return _waves(_angle(signals, joint))


def _of_speed(signals: Signals, joint: int) -> list[np.ndarray]:
    speed = signals.velocity[:, joint] / SPEED
    size, way = np.abs(speed), sliding(signals)[:, joint]
    slow, fast = (np.exp(-((speed * SPEED / s) ** 2)) for s in (SLOW, FAST))
    return [speed * size, speed**3, size, speed**2, way * slow, way * fast, slow, fast]


def _of_direction(signals: Signals, joint: int) -> list[np.ndarray]:
    way = sliding(signals)[:, joint]
    return [way * wave for wave in _waves(_angle(signals, joint))]


def relative_load(signals: Signals, joint: int) -> np.ndarray:
    """Scale the torque that the model needs at a joint by its root mean square.

    Args:
        signals: a conditioned log, `t` ticks.
        joint: index of the joint.

    Returns:
        `(t,)` [-]; unknown ticks zero, and all of a joint without a drive, which transmits no load:
        what the model needs there is the residual itself.
    """
    if signals.subject.passive[joint]:
        return np.zeros(len(signals.time))
    load = np.nan_to_num(signals.rigid[:, joint])
    return np.asarray(load / (float(np.sqrt(np.mean(load**2))) or 1.0))


def _of_strength(signals: Signals, joint: int) -> list[np.ndarray]:
    load = relative_load(signals, joint)
    return [load * wave for wave in _waves(_angle(signals, joint))]


def _of_load(signals: Signals, joint: int) -> list[np.ndarray]:
    load = relative_load(signals, joint)
    way = sliding(signals)[:, joint]
    return [np.abs(load), load * np.abs(load), load**2, load**3, way * load, way * load**2]


def _of_memory(signals: Signals, joint: int) -> list[np.ndarray]:
    angle = np.nan_to_num(signals.position[:, joint])
    return [stop(angle, way) for way in WAYS]


def _of_time(signals: Signals, joint: int) -> list[np.ndarray]:
    share = (signals.time - signals.time[0]) / max(signals.time[-1] - signals.time[0], 1e-9)
    way, speed = sliding(signals)[:, joint], signals.velocity[:, joint] / SPEED
    load, drift = relative_load(signals, joint), 2 * share - 1
    return [drift, drift**2, way * drift, way * drift**2, speed * drift, load * drift]


def _of_others(signals: Signals, joint: int) -> list[np.ndarray]:
    others = [k for k in range(len(signals.subject.joints)) if k != joint]
    near = sorted(others, key=lambda k: (abs(k - joint), k))[: SHAPES // 2]
    states = [signals.position[:, k] - signals.subject.default[k] for k in near]
    return states + [signals.velocity[:, k] / SPEED for k in near]


_FUNCTIONS: dict[str, tuple[str, Callable[[Signals, int], list[np.ndarray]]]] = {
    "position": ("its position, not as a spring's", _of_position),
    "speed": ("its speed, not as friction's", _of_speed),
    "direction": ("its position and the direction of motion", _of_direction),
    "load": ("its load, not in proportion", _of_load),
    "strength": ("its load, in another proportion at each position", _of_strength),
    "memory": ("the way that it came", _of_memory),
    "time": ("time", _of_time),
    "others": ("other joints", _of_others),
}
INPUTS = {name: words for name, (words, _) in _FUNCTIONS.items()}
"""What the torque depends on, in words."""
