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


def _found() -> dict[str, Effect]:
    found = {}
    for place in pkgutil.walk_packages(__path__, f"{__name__}."):
        for kind in vars(importlib.import_module(place.name)).values():
            if (
                inspect.isclass(kind)
                and issubclass(kind, Effect)
                and not inspect.isabstract(kind)
                and kind.__module__ == place.name
            ):
                check_complete(kind)
                found[kind.identifier] = kind()
    return dict(sorted(found.items()))


WEIGHED: dict[str, Effect] = _found()
"""All effects that compete for an answer, by identifier, in the order of the alphabet."""

EFFECTS: dict[str, Effect] = {name: one for name, one in WEIGHED.items() if one.listed}
"""Those of them that answers name as causes: the catalogue."""

UNLISTED = WEIGHED.keys() - EFFECTS.keys()
"""Identifiers of the others."""

LOOK_ALIKES: tuple[tuple[str, str, str], ...] = tuple(
    (one.identifier, other, by) for one in EFFECTS.values() for other, by in one.look_alikes.items()
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
