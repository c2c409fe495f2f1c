"""What motors can give: their peak torque and the torque-speed line of a DC motor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


def limited(
    torque: np.ndarray,
    speed: np.ndarray,
    peak: np.ndarray | float,
    stall: np.ndarray | float,
    free: np.ndarray | float,
    voltage: np.ndarray | float = 1.0,
    jump: np.ndarray | None = None,
) -> np.ndarray:
    """Bring torques of motors within their peak torque and DC-motor line; all broadcast.

    Args:
        torque: as wanted [Nm], `(..., K)`.
        speed: of the motors [rad/s].
        peak: torque [Nm]; infinite where unknown.
        stall: torque of the line [Nm], at the nominal voltage; infinite where unknown.
        free: no-load speed of the line [rad/s], likewise.
        voltage: over the nominal one, which the line follows [-].
        jump: that the torque is less by this in one half of a time and more in the other [Nm].

    Returns:
        The torques, on average over that time [Nm].
    """
    if jump is not None and jump.any():
        line = speed, peak, stall, free, voltage
        return (limited(torque - jump, *line) + limited(torque + jump, *line)) / 2
    with np.errstate(invalid="ignore"):
        droop = np.where(np.isfinite(stall), stall / free, 0.0) * speed
    available = stall * voltage
    torque = np.maximum(np.minimum(torque, available - droop), -available - droop)
    return np.asarray(np.maximum(np.minimum(torque, peak), -peak))


@dataclass(slots=True, eq=False)
class Limits:
    """What motors can give at this moment, `(n, K)` or `(K,)`; as in `Machine`."""

    no_load_speed: np.ndarray
    stall_torque: np.ndarray
    peak_torque: np.ndarray

    def clip(self, torque: np.ndarray, speed: np.ndarray) -> np.ndarray:
        """Bring torques inside the four-quadrant envelope, as `sizing.envelope` does.

        Args:
            torque: as wanted [Nm], `(n, K)`.
            speed: motor velocity [rad/s], `(n, K)`.

        Returns:
            The clipped torque [Nm], `(n, K)`.
        """
        return limited(torque, speed, self.peak_torque, self.stall_torque, self.no_load_speed)
