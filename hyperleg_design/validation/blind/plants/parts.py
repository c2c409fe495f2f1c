"""Parts that both rig plants have: the host's targets, the way of a command to its drive, and
torques that the catalogue of effects lacks. `b` rigs run side by side.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hyperleg_design.validation.blind.plants.plant import RigPlant

HISTORY = 128
"""Commands that a delay line keeps."""


def stacked(plants: Sequence[RigPlant], name: str) -> np.ndarray:
    """Stack one field of all rigs.

    Args:
        plants: `b` rigs of the same robot.
        name: of the field.

    Returns:
        `(b, ...)`.
    """
    return np.stack([np.asarray(getattr(plant, name), float) for plant in plants])


class HostTargets:
    """Targets of the host, between whose ticks the drives interpolate."""

    def __init__(self, targets: np.ndarray, hold: int) -> None:
        self.targets, self.hold = targets, hold

    def at(self, tick: int) -> np.ndarray:
        """Targets at a tick of the drives; the first ones before the recording begins.

        Args:
            tick: of the drives; negative before the recording.

        Returns:
            `(b, n)` [rad].
        """
        row, within = divmod(max(tick, 0), self.hold)
        last = min(row + 1, self.targets.shape[1] - 1)
        step = self.targets[:, last] - self.targets[:, row]
        return self.targets[:, row] + step * (within / self.hold)


class DelayLine:
    """Commands on their way to the drives."""

    def __init__(self, delay: np.ndarray, tick: float) -> None:
        b, m = delay.shape
        self.whole = np.floor(delay / tick).astype(int)
        self.part = delay / tick - self.whole
        self.history = np.zeros((HISTORY, b, m))
        self.rigs, self.motors = np.arange(b)[:, None], np.arange(m)[None]

    def send(self, tick: int, command: np.ndarray, lost: np.ndarray) -> np.ndarray:
        """Send a command.

        Args:
            tick: at which it is sent.
            command: `(b, m)` [Nm].
            lost: rigs to which it does not come `(b, 1)`; the one before it stays there.

        Returns:
            What arrives at this tick `(b, m)` [Nm].
        """
        history, place = self.history, tick % HISTORY
        history[place] = np.where(lost, history[place - 1], command)
        late = (place - self.whole) % HISTORY
        return np.asarray(
            (1 - self.part) * history[late, self.rigs, self.motors]
            + self.part * history[late - 1, self.rigs, self.motors]
        )


class Drives:
    """What drives of both rigs have: limits, a supply that sags, and motors that warm up."""

    def __init__(self, plants: Sequence[RigPlant]) -> None:
        self.peak, self.stall = stacked(plants, "peak_torque"), stacked(plants, "stall_torque")
        self.droop = self.stall / stacked(plants, "no_load_speed")
        self.nominal = stacked(plants, "voltage")[:, None]
        self.supply = stacked(plants, "supply")[:, None]
        self.resistance = stacked(plants, "supply_resistance")[:, None]
        self.heat = stacked(plants, "power_constant")
        self.thermal_resistance = stacked(plants, "thermal_resistance")
        self.thermal_time = stacked(plants, "thermal_time")
        self.temperature = stacked(plants, "start_temperature")
        self.scale, self.derating = stacked(plants, "torque_scale"), stacked(plants, "derating")
        self.bus = np.broadcast_to(self.supply, self.supply.shape).copy()


class UnlistedForces:
    """Torques at the joints that no effect of the catalogue makes, and its linear spring."""

    def __init__(self, plants: Sequence[RigPlant], step: float) -> None:
        self.spring, self.spring_rest = stacked(plants, "spring"), stacked(plants, "spring_rest")
        self.hysteresis, self.push = stacked(plants, "hysteresis"), stacked(plants, "push")
        self.hardening, self.coupling = stacked(plants, "hardening"), stacked(plants, "coupling")
        self.drag, self.rest = stacked(plants, "drag"), stacked(plants, "rest")
        self.frequency = stacked(plants, "push_frequency")[:, None]
        sizes = (self.spring, self.hysteresis, self.push, self.hardening, self.coupling, self.drag)
        self.act = any(size.any() for size in sizes)
        self.step, self.memory = step, np.zeros(self.rest.shape)

    def beside(
        self, torque: np.ndarray | float, time: float, q: np.ndarray, qd: np.ndarray
    ) -> np.ndarray:
        """Go one step on and add these torques.

        Args:
            torque: what acts besides `(b, n)` [Nm].
            time: of the recording [s].
            q: `(b, n)` [rad].
            qd: `(b, n)` [rad/s].

        Returns:
            All of it `(b, n)` [Nm].
        """
        bent, turned = q - self.rest, 4.0 * self.step
        self.memory = (self.memory + turned * qd) / (1.0 + turned * np.abs(qd))
        thrust = np.maximum(np.sin(2 * np.pi * self.frequency * time), 0.0) ** 6
        return np.asarray(
            torque
            + self.push * thrust
            - self.spring * (q - self.spring_rest)
            - self.hysteresis * self.memory
            - self.hardening * bent**3
            - (self.coupling @ bent[:, :, None])[:, :, 0]
            - self.drag * qd * np.abs(qd)
        )


class Ripple:
    """Torques that go with the angle of a motor."""

    def __init__(self, plants: Sequence[RigPlant]) -> None:
        self.amplitude, self.order = stacked(plants, "cogging"), stacked(plants, "cogging_order")
        self.phase, self.share = stacked(plants, "cogging_phase"), stacked(plants, "ripple")
        self.act = bool(self.amplitude.any() or self.share.any())

    def cogging(self, angle: np.ndarray) -> np.ndarray:
        """Torque whatever the motor does.

        Args:
            angle: of the motors `(b, m)` [rad].

        Returns:
            `(b, m)` [Nm].
        """
        return np.asarray(self.amplitude * np.sin(self.order * angle + self.phase))

    def of_torque(self, angle: np.ndarray, torque: np.ndarray) -> np.ndarray:
        """Torque in proportion to the motor's own.

        Args:
            angle: of the motors `(b, m)` [rad].
            torque: of the motors `(b, m)` [Nm].

        Returns:
            `(b, m)` [Nm].
        """
        return np.asarray(
            self.share * torque * (np.sin(5 * angle + 0.4) + 0.6 * np.sin(7 * angle + 1.9))
        )
