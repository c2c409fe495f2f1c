"""A robot of two joints, and what is implausible in its logs."""

from types import SimpleNamespace

import numpy as np

from hyperleg_design.gap.checks.plausibility import implausible
from hyperleg_design.gap.results.finding import ERROR


class Robot:
    """As much of a subject as this looks at."""

    joints = motors = motor_aliases = ("hip", "knee")
    motor_from_joint, motor_scale = np.eye(2), {}
    position_low, position_high = np.array([-1.0, -1.0]), np.array([1.0, 1.0])
    tree = SimpleNamespace(hinge=np.array([True, False]))


def errors(log, subject=None):
    return [(f.signal, f.what) for f in implausible(log, subject) if f.severity == ERROR]


def only(found, signal, word):
    assert [s for s, _ in found] == [signal], found
    assert word in found[0][1]
