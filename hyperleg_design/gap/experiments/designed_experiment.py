"""Recommended motions of one robot, and what they tell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.experiments import information as info
from hyperleg_design.gap.experiments.information import Blocks, Place
from hyperleg_design.gap.experiments.motions import LeftOut, Motion
from hyperleg_design.gap.experiments.pair import Pair, apart
from hyperleg_design.gap.experiments.rig_room import Room
from hyperleg_design.gap.model.subject import Subject

CLEAR = 3.0
"""Standard deviations from which an effect of usual size shows, and from which two are told
apart."""


@dataclass(frozen=True, eq=False)
class Experiment:
    """Recommended motions of one robot and what they tell."""

    subject: Subject
    room: Room
    rate: float
    noise: float
    torque: bool
    """Whether the rig is taken to measure motor torque or current."""
    motions: tuple[Motion, ...]
    left_out: tuple[LeftOut, ...]
    blocks: Blocks
    grams: Mapping[str, np.ndarray]
    """Fisher information by motion `(c, c)`."""
    pairs: tuple[Pair, ...]
    chosen: tuple[str, ...]
    """Shortest set of motions that tells what all of them can, in the order in which they add
    most."""
    notes: tuple[str, ...]

    def motion(self, name: str) -> Motion:
        """Look up a motion.

        Args:
            name: of the motion.

        Returns:
            The motion.
        """
        return next(m for m in self.motions if m.name == name)

    def gram(self, names: Sequence[str] | None = None) -> np.ndarray:
        """Sum the information of some motions.

        Args:
            names: of the motions; all by default.

        Returns:
            Fisher information, `(c, c)`.
        """
        return info.summed(
            self.grams, names if names is not None else [m.name for m in self.motions]
        )

    def apart(self, pair: Pair, names: Sequence[str] | None = None) -> float:
        """Compute how far two look-alikes are told apart by some motions.

        Args:
            pair: of look-alikes.
            names: of the motions; all by default.

        Returns:
            The distance of the less clear of the two [standard deviations].
        """
        return apart(self.gram(names), self.blocks, pair)

    def shown(self, place: Place, names: Sequence[str] | None = None) -> float:
        """Compute how far an effect of usual size stands out.

        Args:
            place: effect and location.
            names: of the motions; all by default.

        Returns:
            The distance [standard deviations].
        """
        return info.strength(self.gram(names), self.blocks, place)


def inseparable(experiment: Experiment) -> tuple[Pair, ...]:
    """List the look-alikes that both show, or would, and that all motions together cannot tell
    apart.

    Args:
        experiment: the plan.

    Returns:
        The pairs.
    """
    gram, unseen = experiment.gram(), hidden(experiment)
    return tuple(
        pair
        for pair in experiment.pairs
        if apart(gram, experiment.blocks, pair) < CLEAR
        and pair.first not in unseen
        and pair.second not in unseen
    )


def hidden(experiment: Experiment) -> tuple[Place, ...]:
    """List the effects at places where, at their usual size, no motion shows them.

    Args:
        experiment: the plan.

    Returns:
        Effects and locations.
    """
    gram = experiment.gram()
    blocks = experiment.blocks
    return tuple(p for p in blocks.places if info.strength(gram, blocks, p) < CLEAR)
