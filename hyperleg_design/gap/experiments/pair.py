"""Pairs of look-alikes at one joint, and how far a motion tells them apart."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import compress

import numpy as np

from hyperleg_design.gap.effects import LOOK_ALIKES
from hyperleg_design.gap.experiments import information as info
from hyperleg_design.gap.experiments.information import Blocks, Place
from hyperleg_design.gap.model.subject import Subject


@dataclass(frozen=True)
class Pair:
    """Two look-alikes at one joint."""

    joint: str
    first: tuple[str, str]
    second: tuple[str, str]
    by: str
    """What separates the two effects."""


def apart(gram: np.ndarray, blocks: Blocks, pair: Pair) -> float:
    """Compute what is left of each of two effects after the other explained what it can.

    Args:
        gram: Fisher information, `(c, c)`.
        blocks: of the robot.
        pair: of look-alikes.

    Returns:
        The lesser of the two [standard deviations].
    """
    return min(
        info.distinction(gram, blocks, pair.first, [pair.second]),
        info.distinction(gram, blocks, pair.second, [pair.first]),
    )


def pairs_of(subject: Subject, blocks: Blocks) -> tuple[Pair, ...]:
    """List the look-alikes joint by joint.

    Args:
        subject: the robot.
        blocks: of the robot.

    Returns:
        The pairs that can sit on this robot.
    """
    pairs: list[Pair] = []
    for first, second, by in LOOK_ALIKES:
        for index, joint in enumerate(subject.joints):
            places = [place_at(name, index, subject, blocks) for name in (first, second)]
            if (
                places[0] is not None
                and places[1] is not None
                and not any((p.first, p.second) == (places[0], places[1]) for p in pairs)
            ):
                pairs.append(Pair(joint, places[0], places[1], by))
    return tuple(pairs)


def place_at(effect: str, joint: int, subject: Subject, blocks: Blocks) -> Place | None:
    """Find where an effect sits that acts on a joint most: the joint, its main motor, the link that
    it carries, or the robot.

    Args:
        effect: its identifier.
        joint: index of the joint.
        subject: the robot.
        blocks: of the robot.

    Returns:
        Effect and location; None where the effect cannot sit there.
    """
    known = [location for name, location in blocks.places if name == effect]
    motor = subject.motors[int(np.argmax(np.abs(subject.joint_from_motor[joint])))]
    links = compress(subject.tree.links, subject.tree.link_joint == joint)
    for name in (subject.joints[joint], motor, *links):
        if name in known:
            return effect, name
    shared = [name for name in known if name in ("robot", "battery")]
    return (effect, shared[0]) if shared else None
