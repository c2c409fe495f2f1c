"""Results of a function, kept for as long as the object that they were computed from exists."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

Owner = TypeVar("Owner")
Rest = ParamSpec("Rest")
Result = TypeVar("Result")
MOST = 256
"""Results of one function of one object that are kept."""


def memoized(
    function: Callable[Concatenate[Owner, Rest], Result],
) -> Callable[Concatenate[Owner, Rest], Result]:
    """Keep the last `MOST` results of a function while its first argument lives.

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
        if key in own:
            return own[key]
        result = own[key] = function(owner, *rest, **named)
        for oldest in tuple(own)[:-MOST]:  # of a copy, as other threads add results meanwhile
            own.pop(oldest, None)
        return result

    return keeping
