"""Laws by name: a design's file names the one that computes its friction, gears or masses."""

from __future__ import annotations

from collections.abc import Callable
from operator import is_
from typing import Any, Generic, TypeVar
from weakref import WeakKeyDictionary

from hyperleg_design.errors import InputError
from hyperleg_design.robot.motors import motors_by_name

Law = TypeVar("Law", bound=Callable[..., Any])


class Laws(Generic[Law]):
    """The laws of one kind.

    Args:
        section: of the design, whose leaf `law` names the law.
    """

    def __init__(self, section: str) -> None:
        self.section = section
        self.by_name: dict[str, Law] = {}
        self._results: WeakKeyDictionary[Any, tuple[tuple[Any, ...], Any]] = WeakKeyDictionary()

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

    def result(self, design: Any) -> Any:
        """Compute what the law that a design names gives for it.

        It is computed once for each design, as long as its names mean the same law and motors.

        Args:
            design: a robot or batch.

        Returns:
            The result of the law, not to be written into.

        Raises:
            InputError: no such law, or a motor is not in the catalogue.
        """
        law = self.of(design)
        names = [*(actuator.motor for actuator in design.every_actuator), *design.reference_motors]
        of = (law, *motors_by_name(names).values())
        known, result = self._results.get(design, ((), None))
        if len(known) != len(of) or not all(map(is_, known, of)):
            result = law(design)
            self._results[design] = (of, result)
        return result
