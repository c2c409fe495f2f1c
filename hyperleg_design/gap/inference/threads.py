"""Work that several threads share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

T = TypeVar("T")
R = TypeVar("R")


def spread(job: Callable[[T], R], items: Sequence[T], threads: int) -> list[R]:
    """Apply a function to items on several threads.

    Args:
        job: the function.
        items: its arguments.
        threads: that share the work.

    Returns:
        The results, in the order of the items.
    """
    if threads <= 1 or len(items) < 2:
        return [job(item) for item in items]
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(job, items))
