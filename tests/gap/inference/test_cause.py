"""A cause's values in usual sizes, and its trace against that of the effect that it linearises."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace

import causes
import numpy as np
import pytest

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.inference.linearisation import linearise, trace_columns

COLUMNS = np.array([[1.0, 0.0, 2.0], [0.5, -1.0, 4.0]])


@pytest.fixture
def cause():
    """A linear one with two parameters and three samples."""
    return replace(
        causes.unbounded("backlash", "knee", COLUMNS),
        values=np.array([3.0, 5.0]),
        nulls=np.array([1.0, 5.0]),
        usual=np.array([0.5, 2.0]),
    )


def test_values_are_counted_in_usual_sizes_from_the_nulls(cause):
    assert cause.phi.tolist() == [4.0, 0.0]
    assert (cause.nulls + cause.phi * cause.usual).tolist() == cause.values.tolist()
    assert cause.name == ("backlash", "knee")


def test_a_linear_trace_is_a_sum_of_its_columns_and_a_linearised_one_has_a_constant(cause):
    assert cause.trace(np.zeros(2)).tolist() == [0.0, 0.0, 0.0]
    assert cause.trace(np.array([2.0, -1.0])).tolist() == [1.5, 1.0, 0.0]
    constant = np.array([10.0, 20.0, 30.0])
    curved = causes.unbounded("backlash", "knee", COLUMNS, constant)
    assert curved.trace(np.array([2.0, -1.0])).tolist() == [11.5, 21.0, 30.0]


def test_a_linear_effect_has_its_whole_trace_from_the_cause(search):
    samples, effect = search.evidence.samples, WEIGHED["viscous_friction"]
    own = linearise(samples, effect, "knee", effect.nulls)
    for value in (-0.1, 0.3):
        expected = trace_columns(samples, effect, "knee", np.array([[value]]))[0]
        phi = (np.array([value]) - own.nulls) / own.usual
        np.testing.assert_allclose(own.trace(phi), expected, rtol=1e-9, atol=1e-12)


def test_a_curved_effect_is_met_where_it_is_linearised_and_near_it_at_second_order(search):
    samples, effect = search.evidence.samples, WEIGHED["stribeck_friction"]
    subject = samples.filtered_logs[0].signals.subject
    values = effect.example("knee", subject)
    own = linearise(samples, effect, "knee", values)
    errors = []
    for step in (0.0, 0.05, 0.1):
        moved = values + step * effect.usual("knee", subject)
        expected = trace_columns(samples, effect, "knee", moved[None])[0]
        errors.append(np.linalg.norm(own.trace((moved - own.nulls) / own.usual) - expected))
    size = np.linalg.norm(trace_columns(samples, effect, "knee", values[None])[0])
    assert errors[0] < 1e-9 * size
    assert errors[1] < errors[2] < 0.01 * size


def test_a_trace_of_other_parameters_and_a_change_in_place_are_refused(cause):
    with pytest.raises(ValueError, match=r"mismatch"):
        cause.trace(np.zeros(3))
    with pytest.raises(FrozenInstanceError):
        cause.location = "hip"
