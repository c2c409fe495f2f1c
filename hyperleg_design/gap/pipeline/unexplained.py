"""What no cause of an answer explains, in words: joints in a limit cycle or that ring, functions
that the catalogue lacks, and channels that are left larger or noisier than a healthy robot's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.channels.channel import Channel
from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.detectors.ringing import MOTION, Ringing, ringing
from hyperleg_design.gap.inference.gap_size import GapSize
from hyperleg_design.gap.inference.posterior import Posterior, expanded
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.unlisted import excess_noise, scatter
from hyperleg_design.gap.results.diagnosis import residual_shape
from hyperleg_design.gap.signals.signals import Signals

CYCLES, RINGS = HIDING = "limit cycle", "ringing"
"""Names in `Diagnosis.residual_shape` of what faults are lost in."""
MOVES = 1.5
"""Motion of a joint where one rings, over that in the references, from which it is mentioned [-];
assumed."""
MOST_CHANNELS = 3
"""Channels that are named where no listed effect says why they are larger or noisier."""


@dataclass(frozen=True, eq=False)
class Unexplained:
    """What is left over beside the most probable hypothesis."""

    evidence: Evidence
    posterior: Posterior
    size: GapSize
    rules: InferenceRules

    @property
    def unlisted_causes(self) -> list[tuple[Cause, str]]:
        """Causes of the most probable hypothesis that the catalogue lacks, and what they do."""
        best = self.posterior.hypothesis
        unlisted = [best.candidates[place] for place in self.posterior.odd]
        return [
            (best.causes[place], WEIGHED[candidate.effect].describe(best.values(place)))
            for place, candidate in expanded(best.candidates)
            if candidate in unlisted
        ]

    @cached_property
    def cycling(self) -> dict[str, float]:
        """Joints in a limit cycle that reference logs lack, and its frequency [Hz]."""
        before = {joint for log in self.evidence.references for joint in _cycles(log)}
        frequencies: dict[str, float] = {}
        for log in self.evidence.signals:
            frequencies |= {joint: f for joint, f in _cycles(log).items() if joint not in before}
        return frequencies

    @cached_property
    def ringing(self) -> dict[tuple[str, str], Ringing]:
        """Residuals that ring, by their names and those of their joints or motors; not those of
        joints in a limit cycle.
        """
        logs = self.evidence.samples.filtered_logs
        count = len(self.evidence.signals)
        over = ringing(logs[:count], logs[count:], self.rules.posterior.ringing)
        return {place: heard for place, heard in over.items() if place[1] not in self.cycling}

    @property
    def hides_faults(self) -> bool:
        """Whether a joint swings or rings so that faults are lost in it."""
        return bool(self.cycling or self.ringing)

    def shapes(self) -> tuple[dict[str, Any], ...]:
        """Describe it for `Diagnosis.residual_shape`, the most telling first."""
        shapes = []
        for joint, frequency in self.cycling.items():
            text = (
                f"swings to and fro at {frequency:.0f} Hz (or a frequency that the log's rate "
                f"folds there), which nothing commands: its control loop is on the edge of "
                f"stability"
            )
            shapes.append(residual_shape(CYCLES, joint, text, 0.0))
        for (residual, name), heard in self.ringing.items():
            text = _rings(heard) if residual == MOTION else _rattles(heard)
            shapes.append(residual_shape(RINGS, name, text, 0.0))
        remainder = self.posterior.remainder
        for cause, text in self.unlisted_causes:
            if not cause.standing:
                shapes.append(residual_shape(cause.effect, cause.location, text, remainder))
        return (*shapes, *self._larger(), *self._noisier())

    def _larger(self) -> list[dict[str, Any]]:
        """Channels of which the causes leave more than a healthy robot does, but those in which a
        cause that the catalogue lacks shows.
        """
        left = np.where(self.size.odd, 0.0, np.maximum(self.size.after - self.size.noise, 0.0))
        shapes = []
        for place in np.argsort(-left, kind="stable").tolist()[:MOST_CHANNELS]:
            if left[place] <= 0 or self.posterior.remainder <= 0:
                continue
            channel = self.evidence.channels[place]
            text = (
                f"the {channel.residual} residual of {channel.name} is left larger or of another "
                f"shape than a healthy robot's, and no listed effect says why"
            )
            share = float(left[place] / max(left.sum(), 1e-300))
            shapes.append(residual_shape("unlisted", channel.name, text, share))
        return shapes

    def _noisier(self) -> list[dict[str, Any]]:
        """Channels with noise that no healthy robot has, the noisiest first; of an answer of `none`
        those that scatter more than in the references, as that is all there is to say then.
        """
        usual = "the references" if self.evidence.references else "healthy robots"
        shapes = []
        if self.posterior.remainder > 0:
            for channel, times in self._noisiest(excess_noise):
                text = (
                    f"the {channel.residual} residual of {channel.name} scatters up to "
                    f"{times:.2g} times as much as in {usual}, in a way that follows no listed "
                    f"effect: look for play, a loose part, something that pushes, or a disturbed "
                    f"signal"
                )
                shapes.append(residual_shape("noise", channel.name, text, 0.0))
        if self.posterior.verdict == "none":
            for channel, times in self._noisiest(scatter):
                text = (
                    f"the {channel.residual} residual of {channel.name} scatters "
                    f"{times:.2g} times as much as in the references, in a way that follows "
                    f"no listed effect, as a healthy robot's does now and then"
                )
                shapes.append(residual_shape("scatter", channel.name, text, 0.0))
        return shapes

    def _noisiest(
        self, ratio: Callable[[Channel, Scales, InferenceRules], float]
    ) -> list[tuple[Channel, float]]:
        """The channels with the largest ratios above 1, at most `MOST_CHANNELS`."""
        channels = self.evidence.channels
        scales = self.posterior.hypothesis.scales
        over = [
            (channel, times)
            for channel, own in zip(channels, scales, strict=True)
            if (times := ratio(channel, own, self.rules)) > 1
        ]
        return sorted(over, key=lambda entry: -entry[1])[:MOST_CHANNELS]


def _rings(heard: Ringing) -> str:
    """What a joint does that rings."""
    text = (
        f"has a torque residual {heard.times:.0f} times as large above the frequencies of its "
        f"motion as in the references, most at {heard.frequency:.0f} Hz, in which small faults "
        f"cannot be seen: look for play, a belt that gives, a loose part, or a control loop on the "
        f"edge of stability"
    )
    if heard.moves > MOVES:
        text += (
            f", first at {heard.mover}, which moves {heard.moves:.2g} times as much there as in "
            f"the references"
        )
    return text


def _rattles(heard: Ringing) -> str:
    """What a motor does that turns to and fro against its joints."""
    return (
        f"turns to and fro against its joints {heard.times:.0f} times as much as in the references "
        f"above the frequencies of its motion, most at {heard.frequency:.0f} Hz: look for play or "
        f"a belt that gives between this motor and its joints"
    )


def _cycles(signals: Signals) -> dict[str, float]:
    """Joints of a log that are in a limit cycle, and its frequency [Hz]."""
    cycle = signals.limit_cycle
    if cycle is None:
        return {}
    joints = np.asarray(signals.subject.joints)[cycle.joints]
    return dict(zip(joints.tolist(), cycle.frequency[cycle.joints].tolist(), strict=True))
