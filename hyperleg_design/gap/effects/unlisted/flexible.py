"""What functions of many shapes that stand for effects outside the catalogue have in common."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects.excitation import Excitation, Motion
from hyperleg_design.gap.effects.kinds import JointEffect
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration

SHARE = 0.003
"""Usual size of one shape over the torque that the joint is made for [-]: so small that a shape
which nothing needs costs nothing; a fit that needs more widens the prior (assumed)."""


class Flexible(JointEffect):
    """At a joint acts a sum of shapes of one of `inputs`, each with a size of its own.

    Priors of the sizes shrink to nothing, so that the marginal likelihood charges for each shape
    that is needed: an effect of the catalogue that fits as well has fewer parameters, and wins.
    """

    listed: ClassVar[bool] = False
    flexible: ClassVar[bool] = True
    linear: ClassVar[bool] = True
    rare: ClassVar[float] = -3.0
    """Assumed: one fault in twenty is of a kind that nobody has listed."""
    inputs: ClassVar[Mapping[str, str]]
    """By name, in words that follow on `sentence`."""
    sentence: ClassVar[str]
    """What happens at the joint, in words."""

    @property
    def sizes(self) -> int:
        """Number of parameters that are sizes of shapes, the first ones."""
        return sum(not parameter.shape for parameter in self.parameters)

    def input_of(self, values: np.ndarray) -> str:
        """Tell the input.

        Args:
            values: of the parameters `(..., parameters)`, all of the same input.

        Returns:
            One of `inputs`.
        """
        return tuple(self.inputs)[round(float(np.reshape(values, -1)[-1]))]

    @override
    def odds(self, location: str, subject: Subject, values: np.ndarray) -> float:
        """Each of the inputs is as likely."""
        return -float(np.log(len(self.inputs)))

    @override
    def variants(self, signals: Signals, location: str) -> np.ndarray:
        variants = np.zeros((len(self.inputs), len(self.parameters)))
        variants[:, -1] = np.arange(len(self.inputs))
        return variants

    @override
    def excited(self, log: Log, motion: Motion) -> Excitation:
        return Excitation(self.identifier, True, (), "any motion shows some shape of it")

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        remedy = "is added to no simulation: nobody knows what it is in other motions"
        raise InputError(self.identifier, "location", location, remedy)

    @override
    def describe(self, values: np.ndarray) -> str:
        return f"{self.sentence} {self.inputs[self.input_of(values)]}"


def parameters(
    count: int,
    unit: str,
    inputs: Mapping[str, str],
    orders: Sequence[str] = (),
    usual: float = SHARE,
) -> tuple[Parameter, ...]:
    """Parameters of a flexible effect.

    Args:
        count: sizes of shapes.
        unit: of these.
        inputs: what the shapes may be of.
        orders: further parameters that only shape.
        usual: size of one shape; of torques, over what the joint is made for.

    Returns:
        Sizes, orders, and the place of the input among all.
    """
    shape = tuple(Parameter(name, "", 1.0, 0.0, 1e4, 1.0, "assumed", shape=True) for name in orders)
    sizes = tuple(
        Parameter(f"size_{i}", unit, 0.0, -1e4, 1e4, usual, "assumed", of_strength=unit == "Nm")
        for i in range(count)
    )
    last = len(inputs) - 1.0
    choice = Parameter(
        "input", "", 0.0, 0.0, last, 1.0, "a choice", shape=True, choices=tuple(inputs)
    )
    return (*sizes, *shape, choice)
