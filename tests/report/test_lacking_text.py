"""Why no trial gives a measure."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.report.evaluation_text import evaluation_rows, evaluation_text
from hyperleg_design.report.lacking_text import (
    FELL,
    NO_ARRIVAL,
    NO_STRIDES,
    NO_WAY,
    lacking_text,
)


def rows(fell=0.0, arrived=1.0, **means):
    given = {"fell": fell, "arrived": arrived, **means}
    return {name: {"mean": mean} for name, mean in given.items()}


@pytest.mark.parametrize(
    ("own", "name", "reason"),
    [
        (rows(fell=1.0, arrived=0.0, time=None), "time", FELL),
        (rows(arrived=0.0, time=None), "time", NO_ARRIVAL),
        (rows(cost_of_transport=None), "cost_of_transport", NO_WAY),
        (rows(steady_speed=None, cadence=None), "cadence", NO_STRIDES),
    ],
)
def test_each_measure_has_its_reason(own, name, reason):
    assert lacking_text(own, [name]) == f"without a value in any trial: {name} ({reason})"


def test_a_measure_of_a_part_that_a_robot_lacks_is_named_alone():
    own = rows(steady_speed=1.3, knee_swing=None)
    assert lacking_text(own, ["knee_swing"]) == "without a value in any trial: knee_swing"
    assert lacking_text(own, []) == ""


def test_a_walk_that_ends_where_the_steady_part_begins_says_so():
    short = WalkProtocol(trials=1, distance=1.5, time_limit=4.0, steady=Steady(begin=1.4))
    evaluation = evaluate("walk_upright-toe-1", short)
    assert evaluation.outcomes == ["arrived"]
    assert np.isnan(evaluation.values("steady_speed")).all()
    text = evaluation_text(evaluation_rows([evaluation]))
    (line,) = [line for line in text.splitlines() if line.startswith("without a value")]
    assert line.endswith(f"({NO_STRIDES})")
    assert "steady_speed" in line
