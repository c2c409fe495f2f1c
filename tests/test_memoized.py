"""Results that are kept while what they are of lives."""

from __future__ import annotations

import gc
import weakref
from concurrent.futures import ThreadPoolExecutor

from hyperleg_design.memoized import MOST, memoized


class Owner:
    pass


def test_a_result_is_computed_once_for_each_owner_and_arguments():
    calls = []

    @memoized
    def added(owner, one, *, two=0):
        calls.append((owner, one, two))
        return [one + two]

    first, second = Owner(), Owner()
    assert added(first, 1) is added(first, 1)
    assert added(first, 1, two=2) == [3]
    assert added(second, 1) is not added(first, 1)
    assert calls == [(first, 1, 0), (first, 1, 2), (second, 1, 0)]


def test_results_go_with_their_owner():
    result = memoized(lambda owner: Owner())
    owner = Owner()
    seen = weakref.ref(result(owner))
    assert seen() is not None
    del owner
    gc.collect()
    assert seen() is None


def test_the_last_results_are_kept_whichever_threads_add_them():
    calls = []

    @memoized
    def doubled(owner, one):
        calls.append(one)
        return 2 * one

    owner = Owner()
    numbers = range(4 * MOST)
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(lambda one: doubled(owner, one), numbers)) == [2 * n for n in numbers]
    doubled(owner, -1)
    known = len(calls)
    assert doubled(owner, -1) == -2
    assert len(calls) == known
    assert doubled(owner, 0) == 0
    assert len(calls) == known + 1
