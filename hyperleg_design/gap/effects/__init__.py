"""The catalogue of effects; each module of this package, and of the packages in it, that has an
`Effect` is one more.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil

from hyperleg_design.errors import InputError, meant
from hyperleg_design.gap.effects.complete import check_complete
from hyperleg_design.gap.effects.effect import Effect


def _discovered_effects() -> dict[str, Effect]:
    """One object of each concrete class of effects in the modules of this package, sorted."""
    effects = {}
    for module in pkgutil.walk_packages(__path__, f"{__name__}."):
        for member in vars(importlib.import_module(module.name)).values():
            if (
                inspect.isclass(member)
                and issubclass(member, Effect)
                and not inspect.isabstract(member)
                and member.__module__ == module.name
            ):
                check_complete(member)
                effects[member.identifier] = member()
    return dict(sorted(effects.items()))


WEIGHED: dict[str, Effect] = _discovered_effects()
"""All effects that compete for an answer, by identifier, in the order of the alphabet."""

EFFECTS: dict[str, Effect] = {name: effect for name, effect in WEIGHED.items() if effect.listed}
"""Those of them that answers name as causes: the catalogue."""

UNLISTED = WEIGHED.keys() - EFFECTS.keys()
"""Identifiers of the others."""

LOOK_ALIKES: tuple[tuple[str, str, str], ...] = tuple(
    (effect.identifier, other, by)
    for effect in EFFECTS.values()
    for other, by in effect.look_alikes.items()
)
"""Pairs that are taken for each other, and what separates them."""


def effect(identifier: str) -> Effect:
    """An effect of the catalogue.

    Args:
        identifier: of the effect.

    Returns:
        The effect.

    Raises:
        InputError: no such effect.
    """
    if identifier in EFFECTS:
        return EFFECTS[identifier]
    raise InputError("effect", "", identifier, meant(identifier, EFFECTS))
