"""Results of a function, kept for as long as the object that they were computed from exists."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

Owner = TypeVar("Owner")
Rest = ParamSpec("Rest")
Result = TypeVar("Result")


def memoized(
    function: Callable[Concatenate[Owner, Rest], Result],
) -> Callable[Concatenate[Owner, Rest], Result]:
    """Keep the results of a function while its first argument lives.

    Args:
        function: of an object that can be referred to weakly, and of hashable arguments; what it
            returns holds no reference to that object, and nobody changes it.

    Returns:
        The function, which computes the result of the same arguments once.
    """
    results: WeakKeyDictionary[Owner, dict[Any, Result]] = WeakKeyDictionary()

    @wraps(function)
    def keeping(owner: Owner, /, *rest: Rest.args, **named: Rest.kwargs) -> Result:
        own, key = results.setdefault(owner, {}), (rest, *sorted(named.items()))
        if key not in own:
            own[key] = function(owner, *rest, **named)
        return own[key]

    return keeping
