"""Bounds of option values."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import pytest

from hyperleg_design.cli.arguments import AtLeast, check_bounds, option
from hyperleg_design.errors import InputError


@dataclass(frozen=True)
class Inner:
    rate: Annotated[float, AtLeast(0, exclusive=True)] = 200.0


@dataclass(frozen=True)
class Command:
    worker_count: Annotated[int, AtLeast(1)] = 2
    budget: Annotated[float | None, AtLeast(0)] = None
    name: str = ""
    inner: Inner = field(default_factory=Inner)


def test_a_bound_admits_itself_unless_it_is_exclusive_and_nothing_that_is_not_finite():
    assert AtLeast(1).admits(1)
    assert not AtLeast(1).admits(0.999)
    assert not AtLeast(0, exclusive=True).admits(0)
    assert AtLeast(0, exclusive=True).admits(1e-9)
    assert not any(AtLeast(0).admits(v) for v in (float("nan"), float("inf")))


def test_what_is_within_bounds_passes_and_an_option_that_is_left_out_is_no_number():
    check_bounds(Command())
    check_bounds(Command(budget=0.0))


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (Command(worker_count=0), ["--worker-count = 0", "at least 1"]),
        (Command(budget=-1.0), ["--budget = -1.0", "at least 0"]),
        (Command(worker_count=10**20), ["--worker-count = 1000", "at most 9223372036854775807"]),
        (Command(worker_count=10**400), ["--worker-count = ", "at most 9223372036854775807"]),
        (Command(budget=float("inf")), ["--budget = inf", "at least 0"]),
        (Command(inner=Inner(rate=0.0)), ["--rate = 0.0", "above 0"]),
    ],
)
def test_what_is_beyond_a_bound_is_named_as_it_is_typed(command, words):
    with pytest.raises(InputError) as caught:
        check_bounds(command)
    for word in words:
        assert word in str(caught.value)


def test_options_are_written_with_dashes():
    assert option("only_make") == "--only-make"
