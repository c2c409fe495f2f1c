"""Joints whose position matters: for the torques that a robot needs, and for the direction of what
they carry.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.subject import Subject

UPRIGHT = 1e-6
"""Sine of the angle to gravity below which an axis counts as vertical [-]."""


def turning(subject: Subject) -> np.ndarray:
    """Find the joints whose link changes its direction: they turn, or one that carries them does.

    Args:
        subject: the robot.

    Returns:
        `(n,)` of bool.
    """
    tree = subject.tree
    chains = [tree.chain(joint) for joint in range(tree.count)]
    return np.array([subject.floating or bool(tree.hinge[chain].any()) for chain in chains], bool)


def posture_dependent(subject: Subject) -> np.ndarray:
    """Find the joints whose position changes the torques that the robot needs.

    A slide on a base that stands still carries its load alike everywhere, unless a joint before it
    turns or it has a spring; so does a first joint that turns about the vertical.

    Args:
        subject: the robot.

    Returns:
        `(n,)` of bool.
    """
    tree = subject.tree
    down = subject.gravity / max(float(np.linalg.norm(subject.gravity)), 1e-9)
    dependent = []
    for joint in range(tree.count):
        *before, _ = tree.chain(joint)
        axis = tree.rotation[joint][:, 2]
        leans = float(np.linalg.norm(np.cross(axis, down))) > UPRIGHT
        alone = leans if tree.hinge[joint] else False
        carried = bool(before) if tree.hinge[joint] else bool(tree.hinge[before].any())
        dependent.append(subject.floating or bool(subject.spring[joint]) or carried or alone)
    return np.array(dependent, bool)
