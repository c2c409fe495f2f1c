"""Any states of a robot, for what must hold in all of them."""

import numpy as np

from hyperleg_design.gap.model.base import BaseMotion
from hyperleg_design.gap.model.mechanism import quaternion_rotation

TICKS = 6


def random_motion(subject, seed=0):
    """Any states, and the motion of the base if that floats."""
    rng = np.random.default_rng(seed)
    q, v, a = rng.normal(size=(3, TICKS, len(subject.joints)))
    if not subject.floating:
        return q, v, a, None
    place, linear, spin, force, angular = rng.normal(size=(5, TICKS, 3))
    return (
        q,
        v,
        a,
        BaseMotion(
            place,
            quaternion_rotation(rng.normal(size=(TICKS, 4))),
            linear,
            spin,
            5 * force,
            angular,
        ),
    )
