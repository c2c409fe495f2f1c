"""A made-up recording of two joints, plausible in all ways unless it is spoiled."""

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata


def rig_log(ticks=4000, step=0.005, seed=0, **metadata):
    rng = np.random.default_rng(seed)
    time = np.arange(ticks) * step
    signals = {}
    for joint, speed, size in (("hip", 2.0, 0.6), ("knee", 3.1, 0.5)):
        target = size * np.sin(speed * time + 0.05 * time**2)
        position = 0.95 * size * np.sin(speed * (time - 0.03) + 0.05 * (time - 0.03) ** 2)
        velocity = np.gradient(position, time)
        torque = 20 * (target - position) - velocity
        noise = {
            name: rng.normal(0, s, ticks) for name, s in (("p", 1e-4), ("v", 5e-3), ("t", 5e-3))
        }
        signals |= {
            f"position_target/{joint}": target,
            f"position/{joint}": position + noise["p"],
            f"velocity/{joint}": velocity + noise["v"],
            f"motor_torque_command/{joint}": torque,
            f"motor_torque/{joint}": torque + noise["t"],
            f"motor_current/{joint}": torque / 0.5 + noise["t"],
        }
    given = {
        "gains": {"hip": (20.0, 1.0), "knee": (20.0, 1.0)},
        "torque_constant": {"hip": 0.5, "knee": 0.5},
        **metadata,
    }
    return Log("rig", time, signals, Metadata(**given))


def spoiled(log, **changes):
    """A copy with some columns (given as `position__hip`) replaced, or removed where None."""
    signals = dict(log.signals)
    for key, values in changes.items():
        column = key.replace("__", "/")
        if values is None:
            signals.pop(column)
        else:
            signals[column] = values(signals[column]) if callable(values) else values
    return log.changed(signals=signals)
