from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.sweep.searching.constraint import (
    Constraint,
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
    names = {c.name for c in usual_constraints(["walk"])}
    assert names == {"walk.fell", "walk.thermal_peak", "walk.limit_share"}
