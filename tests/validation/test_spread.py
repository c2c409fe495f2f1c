"""Jobs in processes of their own give what they give here, and an error ends them all."""

from __future__ import annotations

import os

import pytest

from hyperleg_design.validation.spread import ONE_THREAD, spread


def test_processes_side_by_side_give_what_one_gives(monkeypatch):
    for name in ONE_THREAD:
        monkeypatch.delenv(name, raising=False)
    arguments = [(2, k) for k in range(4)]
    alone = list(spread(pow, arguments, 1))
    assert alone == [1, 2, 4, 8]
    assert sorted(spread(pow, arguments, 2)) == alone
    found = set(spread(os.getenv, [(name,) for name in ONE_THREAD], 2))
    assert found == {"1"}


def test_one_job_runs_in_this_process():
    assert list(spread(os.getpid, [()], 8)) == [os.getpid()]
    assert list(spread(os.getpid, [], 8)) == []


def test_the_first_error_is_that_of_the_run():
    with pytest.raises(ZeroDivisionError):
        list(spread(divmod, [(1, 0), (1, 1), (1, 2)], 2))
