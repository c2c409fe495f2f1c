from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.inference.samples import BLOCKS, LOGS
from hyperleg_design.gap.inference.thresholds import load_thresholds
from hyperleg_design.gap.pipeline.answer import Answer


def test_of_a_small_gap_rivals_close_what_they_close_over_what_is_left():
    held = {
        name: SimpleNamespace(held=SimpleNamespace(bare=0.9, square=left))
        for name, left in (("chosen", 0.4), ("rival", 0.65), ("none", 0.9))
    }
    report = object.__new__(Answer)
    report.judge = SimpleNamespace(gap=lambda value, rows: value, thresholds=load_thresholds())
    report.found = SimpleNamespace(
        slots=((held["chosen"],),), rows=np.ones(1, bool), model=held["chosen"]
    )
    report.held = lambda model: model.held
    assert report.small
    assert [report.closed(held[name]) for name in ("chosen", "rival", "none")] == pytest.approx(
        [1.0, 0.5, 0.0]
    )
    held["chosen"].held.bare = 1.2
    assert not report.small, "a gap over the floor is measured against the floor"


@pytest.mark.parametrize(
    ("way", "small", "left", "closed", "told", "carries"),
    [
        (LOGS, False, 3.0, 0.2, (1, 1), False),
        (LOGS, False, 3.0, 0.3, (1, 1), True),
        (LOGS, False, 1.2, 0.2, (1, 1), True),
        (LOGS, True, 3.0, 0.2, (1, 1), True),
        (BLOCKS, False, 3.0, 0.2, (1, 1), True),
        (LOGS, False, 3.0, 0.2, (0, 0), True),
        (LOGS, False, 3.0, 0.2, (1, 0), True),
        (LOGS, False, 3.0, 0.2, (0, 1), False),
    ],
)
def test_causes_must_close_much_of_the_gap_of_whole_logs_that_were_held_out(
    way, small, left, closed, told, carries
):
    """Of two blocks the second alone has a gap; only blocks of logs whose causes the other logs
    tell count.
    """

    def gap(square, rows, blocks):
        return left if blocks[1] else 1.0

    judge = SimpleNamespace(
        holds={},
        thresholds=load_thresholds(),
        gap=gap,
        rows=lambda square: np.full(2, left**2),
        closed=lambda *_: closed,
    )
    judge.base = SimpleNamespace(samples=SimpleNamespace(rows=[SimpleNamespace(name="knee")]))
    model = SimpleNamespace(held=SimpleNamespace(square=None))
    report = SimpleNamespace(
        way=way, small=small, judge=judge, found=SimpleNamespace(model=model, rows=np.ones(2, bool))
    )
    report.held, report.told = lambda one: one.held, np.array(told, bool)
    assert Answer.carries_over(report) is carries
