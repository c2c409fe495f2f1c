"""ROS 2 messages from their bytes in CDR: joint states, inertial measurements, batteries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

JOINT_STATE = "sensor_msgs/msg/JointState"
IMU = "sensor_msgs/msg/Imu"
BATTERY = "sensor_msgs/msg/BatteryState"
READ = (JOINT_STATE, IMU, BATTERY)
"""Types that are decoded."""


class CdrError(Exception):
    """A message shorter than its type, or in an encoding that is not plain CDR."""


class Cursor:
    """Walks through one message; alignment counts from behind the four bytes of the
    encapsulation.
    """

    def __init__(self, data: bytes) -> None:
        if len(data) < 4 or data[0] != 0 or data[1] not in (0, 1):
            raise CdrError("is not plain CDR")
        self._data, self._place, self._order = memoryview(data)[4:], 0, "<" if data[1] else ">"

    def numbers(self, kind: str, count: int) -> np.ndarray:
        """`count` numbers of a NumPy kind, `f8`, `i4`."""
        dtype = np.dtype(self._order + kind)
        start = -(-self._place // dtype.itemsize) * dtype.itemsize
        stop = start + count * dtype.itemsize
        if count < 0 or stop > len(self._data):
            raise CdrError("ends early")
        if count:
            self._place = stop
        return np.frombuffer(self._data[start:stop], dtype)

    def count(self) -> int:
        """Length of what follows."""
        return int(self.numbers("u4", 1)[0])

    def text(self) -> str:
        """A text, its closing zero left off."""
        return bytes(self.numbers("u1", self.count())).rstrip(b"\0").decode("utf-8", "replace")

    def sequence(self, kind: str) -> np.ndarray:
        """Numbers with their count in front."""
        return self.numbers(kind, self.count())

    def stamp(self) -> float:
        """Time of a std_msgs/Header [s]; its frame is read over."""
        seconds, nanoseconds = self.numbers("i4", 1)[0], self.numbers("u4", 1)[0]
        self.text()
        return float(seconds) + float(nanoseconds) * 1e-9


@dataclass(frozen=True, eq=False)
class JointState:
    """sensor_msgs/JointState; arrays as long as the names, or empty."""

    stamp: float
    names: tuple[str, ...]
    position: np.ndarray
    velocity: np.ndarray
    effort: np.ndarray


def joint_state(data: bytes) -> JointState:
    """Decode a sensor_msgs/JointState.

    Raises:
        CdrError: damaged.
    """
    cursor = Cursor(data)
    stamp = cursor.stamp()
    names = tuple(cursor.text() for _ in range(_bounded(cursor.count(), data)))
    position, velocity, effort = (cursor.sequence("f8") for _ in range(3))
    return JointState(stamp, names, position, velocity, effort)


def imu(data: bytes) -> tuple[float, np.ndarray]:
    """Decode a sensor_msgs/Imu: stamp, and orientation w x y z, angular velocity, linear
    acceleration `(10,)`; NaN where unknown.

    Raises:
        CdrError: damaged.
    """
    cursor = Cursor(data)
    stamp = cursor.stamp()
    x, y, z, w = cursor.numbers("f8", 4)
    orientation = np.array([w, x, y, z])
    if cursor.numbers("f8", 9)[0] == -1:  # by ROS's convention: no such measurement
        orientation[:] = np.nan
    gyro = cursor.numbers("f8", 3).astype(float)
    if cursor.numbers("f8", 9)[0] == -1:
        gyro[:] = np.nan
    acceleration = cursor.numbers("f8", 3).astype(float)
    if cursor.numbers("f8", 9)[0] == -1:
        acceleration[:] = np.nan
    return stamp, np.concatenate([orientation, gyro, acceleration])


def battery(data: bytes) -> tuple[float, float]:
    """Decode a sensor_msgs/BatteryState: stamp and voltage [V].

    Raises:
        CdrError: damaged.
    """
    cursor = Cursor(data)
    return cursor.stamp(), float(cursor.numbers("f4", 1)[0])


def _bounded(count: int, data: bytes) -> int:
    if count > len(data):
        raise CdrError("ends early")
    return count
