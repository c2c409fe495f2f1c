"""Laws by name: a design's file names the one that computes its friction, gears or masses."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar

from hyperleg_design.errors import InputError

Law = TypeVar("Law", bound=Callable[..., Any])


class Laws(Generic[Law]):
    """The laws of one kind.

    Args:
        section: of the design, whose leaf `law` names the law.
    """

    def __init__(self, section: str) -> None:
        self.section = section
        self.by_name: dict[str, Law] = {}

    def register(self, name: str) -> Callable[[Law], Law]:
        """Add a law under the name by which designs choose it.

        Args:
            name: of the law.

        Returns:
            A decorator for the function that is the law.
        """

        def add(law: Law) -> Law:
            self.by_name[name] = law
            return law

        return add

    def of(self, design: Any) -> Law:
        """Look up the law that a design names.

        Args:
            design: a robot or batch.

        Returns:
            The law.

        Raises:
            InputError: no such law.
        """
        name = getattr(design, self.section).law
        if name not in self.by_name:
            known = ", ".join(sorted(self.by_name))
            where = design.source or design.name
            raise InputError(where, f"{self.section}.law", name, f"expects one of {known}")
        return self.by_name[name]
