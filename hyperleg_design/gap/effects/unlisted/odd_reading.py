"""Joint encoders that are wrong in another way than by a constant."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.needed import needed
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.unlisted.flexible import Flexible, parameters
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.memoized import memoized

ORDERS = (1, 2, 3, 4)
"""Periods of the error in one turn [-] (assumed: eccentric discs, and scales that are read from
several sides)."""
USUAL = 0.001
"""Usual size of one shape [rad], as small as `flexible.SHARE`."""
INPUTS = {"position": "that repeats with its angle", "time": "that grows with time"}


class OddReading(Flexible):
    """A joint stands at the logged position minus an error f: a sum of waves of its angle, or a
    drift with time; controller and log read the same wrong angle.

    Trace, at first order in the error: needed(q - f, v - f', a - f'') - needed(q, v, a), where the
    dashes are derivatives in time.
    """

    identifier: ClassVar[str] = "odd_reading"
    summary: ClassVar[str] = "a joint's encoder is wrong by an angle that is no constant"
    inputs: ClassVar[Mapping[str, str]] = INPUTS
    sentence: ClassVar[str] = "is read with an error"
    parameters: ClassVar[tuple[Parameter, ...]] = parameters(
        2 * len(ORDERS), "rad", INPUTS, usual=USUAL
    )

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        joint, name = signals.subject.joints.index(location), self.input_of(values)
        settings = np.atleast_2d(np.asarray(values, float))
        return {
            residual: np.tensordot(settings[:, : len(traces)], traces, 1)
            for residual, traces in _of_shapes(signals, joint, name).items()
        }


@memoized
def _of_shapes(signals: Signals, joint: int, name: str) -> dict[str, np.ndarray]:
    """What each shape leaves, over its size `(shapes, t, rows)` a residual."""
    plain = needed(signals, signals.position)
    traces: dict[str, list[np.ndarray]] = {residual: [] for residual in plain}
    for error, rate, bend in _shapes(signals, joint, name):
        motion = [x.copy() for x in (signals.position, signals.velocity, signals.acceleration)]
        for whole, part in zip(motion, (error, rate, bend), strict=True):
            whole[:, joint] -= USUAL * part
        for residual, moved in needed(signals, *motion).items():
            own = (moved - plain[residual]) / USUAL
            if residual == "motion":
                own[:, joint] -= signals.subject.spring[joint] * error
            traces[residual].append(own)
    return {residual: np.array(parts) for residual, parts in traces.items()}


def _shapes(
    signals: Signals, joint: int, name: str
) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """An error over its size, and its first two derivatives in time `(t,)` each."""
    q, v, a = (x[:, joint] for x in (signals.position, signals.velocity, signals.acceleration))
    if name == "time":
        span = max(float(signals.time[-1] - signals.time[0]), 1e-9)
        share = (signals.time - signals.time[0]) / span
        ones, zeros = np.ones_like(share), np.zeros_like(share)
        return [(share, ones / span, zeros), (share**2, 2 * share / span, 2 * ones / span**2)]
    traces = []
    for k in ORDERS:
        cos, sin = np.cos(k * q), np.sin(k * q)
        traces.append((cos, -k * sin * v, -k * (k * cos * v**2 + sin * a)))
        traces.append((sin, k * cos * v, k * (-k * sin * v**2 + cos * a)))
    return traces
