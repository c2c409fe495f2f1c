"""The register of measures."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.robot.load import load_robot
from hyperleg_design.sweep.measuring import measures
from hyperleg_design.sweep.measuring.batch import Batch
from hyperleg_design.sweep.measuring.measure import BOTH, HYPERLEG, MEASURES, measure


@pytest.fixture
def register(monkeypatch):
    """The register, of which a test changes a copy."""
    copy = dict(MEASURES)
    monkeypatch.setattr("hyperleg_design.sweep.measuring.measure.MEASURES", copy)
    return copy


def test_a_function_is_a_measure_by_its_name_and_docstring(register):
    @measure("kg", "low", families=BOTH, usual=False)
    def all_of_it(batch: Batch) -> np.ndarray:
        """Mass of the whole robot.

        And more of it.
        """
        return np.zeros(batch.size)

    found = register["all_of_it"]
    assert (found.unit, found.better, found.families, found.usual) == ("kg", "low", BOTH, False)
    assert found.doc.startswith("Mass of the whole robot")
    assert "more" not in found.doc
    assert found.compute is all_of_it
    assert found.columns == ("all_of_it",)


@pytest.mark.parametrize(
    ("better", "doc", "name"),
    [("most", "Mass.", "new"), ("low", "", "new"), ("low", "Mass.", next(iter(MEASURES)))],
)
def test_bad_measures_are_refused_and_not_kept(register, better, doc, name):
    def function(batch):
        return batch

    function.__doc__ = doc
    before = dict(register)
    with pytest.raises(ValueError, match=f"measure {name}"):
        measure("kg", better, name=name)(function)
    assert register == before


@pytest.mark.parametrize("robot", ["hyperleg", "mini_cheetah"])
def test_each_column_holds_one_value_of_each_design(robot):
    design = load_robot(robot)
    batch = Batch(design)
    family = HYPERLEG if robot == "hyperleg" else BOTH[1]
    own = [one for one in MEASURES.values() if family in one.families]
    assert len(own) > 5
    names = [column for one in own for column in one.columns_of(design)]
    assert len(set(names)) == len(names)
    for one in own:
        values = np.asarray(one.compute(batch))
        columns = len(one.columns_of(design))
        assert values.size == columns, one.name
        assert np.isfinite(values).all(), one.name
    assert measures.MEASURES is MEASURES
