"""Log odds of causes before any log, over those of any other cause in their place."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.fit import Cause

PER_PARAMETER = 0.5
"""Log prior odds against each parameter, beside what held-out data say."""
RARE = {
    "transmission_ratio": -0.5,
    "voltage_sag": -1.0,
    "thermal_derating": -0.5,
    "controller_gain": -1.5,
    "link_com": -1.0,
}
"""Log prior odds of effects that look like another and are rarer (assumed: belts have the ratio of
their teeth, controllers the gains that they were told, links the centre of mass of their drawing,
while zeros of encoders slip)."""
LARGEST_ERROR, HEAVIER, OWN_MASS = 0.8, 5.0, 0.1
"""Error over a link's own mass from which it is rather something that hangs there; log odds for as
much again; the usual error."""
UNSEEN = {"voltage_sag": 6.0, "thermal_derating": 1.0}
"""Log prior odds against what follows a signal that nobody logged: a model of it fits much."""
NEGATIVE = 8.0
"""Log prior odds against a load that weighs less than nothing, beyond what is declared."""
INWARD, OUTERMOST = 3.0, 2.0
"""Log prior odds against a load far from the ends of a robot, and for one on a link that carries
none, or on a base (assumed: loads hang on hands and lie on backs)."""
GONE, MISSING, HALF = ("coulomb_friction", "viscous_friction", "rotor_inertia"), 4.0, 0.5
"""Effects of which a model may have too much, and log odds against more than this share of the
model's being missing (assumed: friction that nobody described is usual, and joints run in, but none
runs freely, nor is a rotor without inertia)."""


def prior_odds(cause: Cause, values: np.ndarray) -> float:
    """Of a cause at some values `(k,)` [nat]."""
    free = int((~cause.shape).sum() if cause.linear else (cause.high > cause.low).sum())
    found = -PER_PARAMETER * free + RARE.get(cause.effect, 0.0) + cause.odds
    if cause.unseen:
        found -= UNSEEN[cause.effect]
    if cause.effect in GONE and values[0] < HALF * cause.low[0] < 0:
        found -= MISSING
    if cause.effect == "link_mass":
        found -= HEAVIER * max(
            abs(float(values[0])) * OWN_MASS / float(cause.usual[0]) - LARGEST_ERROR, 0.0
        )
    if cause.effect == "payload":
        found -= (
            NEGATIVE * (values[0] < -cause.declared)
            + INWARD * (cause.beyond > 1)
            - OUTERMOST * (cause.beyond == 0)
        )
    return found
