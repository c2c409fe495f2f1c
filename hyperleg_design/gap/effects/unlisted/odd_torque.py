"""Torque at a joint that no effect of the catalogue describes: a smooth function of one input."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placing import at_joint
from hyperleg_design.gap.effects.unlisted.flexible import Flexible, parameters
from hyperleg_design.gap.effects.unlisted.inputs import INPUTS, SHAPES, functions
from hyperleg_design.gap.signals.signals import Signals


class OddTorque(Flexible):
    """A joint takes a torque that is a smooth function of one of `INPUTS`, and is none of those
    that effects of the catalogue leave. Trace: the sum of the functions of that input.
    """

    identifier: ClassVar[str] = "odd_torque"
    summary: ClassVar[str] = "a joint takes a torque that no effect of the catalogue describes"
    inputs: ClassVar[Mapping[str, str]] = INPUTS
    sentence: ClassVar[str] = "takes a torque that depends on"
    parameters: ClassVar[tuple[Parameter, ...]] = parameters(SHAPES, "Nm", INPUTS)

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        joint = signals.subject.joints.index(location)
        settings = np.atleast_2d(np.asarray(values, float))
        torque = np.zeros((len(settings), len(signals.time)))
        for number in np.unique(settings[:, -1]).tolist():
            own = settings[:, -1] == number
            basis = functions(signals, joint, self.input_of(np.array(number)))
            torque[own] = settings[own, : len(basis)] @ basis
        return at_joint(signals, joint, torque)
