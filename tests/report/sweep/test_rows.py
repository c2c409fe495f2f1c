"""Rows of fronts, thinned rows, and where the unchanged design lies on an axis."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.report.sweep.rows import (
    base_level,
    base_value,
    fronts_of,
    thinned,
    without_variants,
)
from hyperleg_design.sweep.spaces.axis import Axis


@given(st.integers(0, 5000), st.integers(2, 200))
def test_thinned_rows_keep_both_ends_and_their_order(count, most):
    chosen = thinned(count, most)
    assert len(chosen) == min(count, most)
    assert np.all(np.diff(chosen) > 0)
    if count:
        assert (chosen[0], chosen[-1]) == (0, count - 1)


def sweep_of(**values):
    return SimpleNamespace(base={"toe.mass": 0.22, "actuators.knee.motor": "RI70"}, **values)


def test_the_unchanged_design_lies_at_its_value_or_at_the_factor_one():
    own = Axis("toe.mass", ("toe.mass",), (0.1, 0.2, 0.5))
    factor = Axis("mass", ("toe.mass",), (0.5, 0.9, 2.0), scaled=True)
    assert base_value(own, sweep_of()) == 0.22
    assert base_value(factor, sweep_of()) == 1.0
    assert base_level(own, sweep_of()) == 0.2
    assert base_level(factor, sweep_of()) == 0.9


@pytest.mark.parametrize(
    ("motors", "level"), [(("RI60", "RI70"), "RI70"), (("RI80", "RI60"), "RI80")]
)
def test_a_motor_that_is_no_level_gives_the_first(motors, level):
    assert base_level(Axis("m", ("actuators.knee.motor",), motors), sweep_of()) == level


def result_of(rows):
    """A sweep of two objectives: total mass is better low, peak torque better high."""
    names = ("variant", "total_mass", "max_joint_torque.knee")
    table = dict(zip(names, map(np.array, zip(*rows, strict=True)), strict=True))
    sweep = SimpleNamespace(
        axes=(),
        objectives=names[1:],
        variants=("toe", "toe_locked", "toe_removed"),
        source="a.yaml",
    )
    return SimpleNamespace(sweep=sweep, columns=lambda columns: {c: table[c] for c in columns})


def test_each_variant_has_a_front_of_its_own():
    rows = [
        ("toe", 30.0, 200.0),
        ("toe", 31.0, 190.0),  # heavier and weaker than the first
        ("toe", 29.0, 150.0),
        ("toe_locked", 40.0, 100.0),
        ("toe_removed", 20.0, np.nan),
    ]
    _, fronts = fronts_of(result_of(rows))
    assert {name: front.tolist() for name, front in fronts.items()} == {
        "toe": [0, 2],
        "toe_locked": [3],
    }


def test_without_any_front_the_objectives_are_named():
    with pytest.raises(InputError, match=r"a\.yaml: objectives .*no design has all"):
        fronts_of(result_of([("toe", np.nan, 1.0)]))


def test_a_column_of_variants_stands_only_where_there_are_some():
    heads, rows = ["a", "variant", "b"], [[1, "as_described", 2]]
    assert without_variants(heads, rows) == (["a", "b"], [[1, 2]])
    assert without_variants(heads, [[1, "toe", 2]]) == (heads, [[1, "toe", 2]])
