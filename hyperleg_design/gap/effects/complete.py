"""What the class of an effect must state, checked where the catalogue takes it up."""

from __future__ import annotations

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects.effect import Effect

STATED = ("identifier", "kind", "summary", "parameters")
"""Fields that every effect states."""
REPLACED = {
    "needs": ("excited", "the motion that shows it"),
    "hooks": ("alteration", "what it does in each step of a simulation"),
}
"""Fields that an effect states unless it overrides the method that reads them: the method, and what
the field is."""


def check_complete(kind: type[Effect]) -> None:
    """Refuse an effect that lacks a field which a diagnosis or a simulation would ask it for.

    Args:
        kind: class of the effect.

    Raises:
        InputError: a field is missing; names the effect and the field.
    """
    name = getattr(kind, "identifier", "")
    where = f"{kind.__module__}.{kind.__qualname__}" + (f" ({name})" if name else "")
    for field in STATED:
        if not hasattr(kind, field):
            raise InputError(where, field, None, "is missing: every effect states it")
    for field, (method, words) in REPLACED.items():
        if not hasattr(kind, field) and getattr(kind, method) is getattr(Effect, method):
            raise InputError(
                where, field, None, f"is missing: state {words}, or override {method}()"
            )
