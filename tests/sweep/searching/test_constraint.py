from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.sweep.searching.constraint import (
    Constraint,
    earlier_constraints,
    read_constraint,
    usual_constraints,
)


def test_constraints_are_read_strictly():
    found = read_constraint("walk.thermal_peak <= 1.5", ["walk"])
    assert found == Constraint("walk.thermal_peak", 1.5, True)
    assert found.violation(2.0) == 0.5
    assert found.violation(np.nan) == np.inf
    assert read_constraint("total_mass>=30", []).violation(31.0) == -1.0
    for text in (
        "thermal_peak",
        "walk.fell<=x",
        "walk.fell<0.1",
        "fall<=1",
        "fell<=nan",
        "fell>=-inf",
    ):
        with pytest.raises(InputError):
            read_constraint(text, ["walk"])
    assert found.text == "walk.thermal_peak<=1.5"


def test_by_default_designs_walk_within_their_limits():
    texts = [c.text for c in usual_constraints(["walk", "t_test"])]
    limits = ["thermal_peak<=1", "limit_share<=0.05"]
    wanted = [f"{p}.{t}" for p in ("walk", "t_test") for t in ("arrived>=0.95", *limits)]
    assert texts == wanted


def test_the_constraints_of_earlier_searches_are_read_back_from_their_texts():
    bounds = earlier_constraints(["walk"])
    assert [c.text for c in bounds] == [
        "walk.fell<=0.05",
        "walk.thermal_peak<=1",
        "walk.limit_share<=0.05",
    ]
    assert tuple(read_constraint(c.text, ["walk"]) for c in bounds) == bounds
