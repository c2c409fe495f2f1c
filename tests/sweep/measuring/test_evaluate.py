from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.sweep.measuring import evaluate, measures
from hyperleg_design.sweep.space import sweep_from_mapping

MEASURES = ["total_mass", "swing_inertia", "torque_alone", "push_off_heat"]

# a ball 0.6 m ahead of the ankle makes the foot longer than this short leg
SWEEP = sweep_from_mapping(
    {
        "design": "hyperleg",
        "variants": ["toe", "toe_removed_matched"],
        "sampling": "random",
        "count": 40,
        "seed": 2,
        "axes": {
            "foot.ball_length": {"low": 0.1, "high": 0.6},
            "toe.mass": {"low": 0.1, "high": 0.5},
            "actuators.knee.motor": {"values": ["RI60", "RI70"]},
        },
        "measures": MEASURES,
        "set": {"thigh.length": 0.28},
    }
)


def test_impossible_designs_are_told_apart_and_the_others_kept():
    rows = evaluate.evaluate_range(SWEEP, 0, 40)
    rejected = rows["rejected"] != ""
    assert 0 < rejected.sum() < len(rejected)
    leg = sum(SWEEP.base[p] for p in ("thigh.length", "shank.length", "foot.ankle_height"))
    foot = SWEEP.base.foot.heel_length + rows["foot.ball_length"] + SWEEP.base.toe.length
    np.testing.assert_array_equal(rejected, foot >= leg)
    assert set(rows["rejected"][rejected]) == {
        "foot.ball_length: makes the foot longer than the leg; lengths are metres"
    }
    for column in measures.columns(SWEEP.measures):
        assert np.isnan(rows[column][rejected]).all()
        if not column.endswith(".toe"):
            assert np.isfinite(rows[column][~rejected]).all()


def test_rows_are_those_of_each_design_alone():
    """Samples and variants in order, each value as the single design has it."""
    rows = evaluate.evaluate_range(SWEEP, 0, 40)
    np.testing.assert_array_equal(rows["sample"], np.repeat(np.arange(40), 2))
    np.testing.assert_array_equal(rows["variant"][:4], ["toe", "toe_removed_matched"] * 2)
    samples = SWEEP.samples()
    for row in range(0, 80, 7):
        one = {
            name: values[rows["sample"][row] : rows["sample"][row] + 1]
            for name, values in samples.items()
        }
        try:
            expected = measures.evaluate(SWEEP.design(one, rows["variant"][row]), SWEEP.measures)
        except InputError:
            assert rows["rejected"][row]
            continue
        for column, values in expected.items():
            np.testing.assert_allclose(rows[column][row], values[0], rtol=1e-12)


@given(cuts=st.lists(st.integers(1, 39), max_size=5, unique=True))
@settings(max_examples=8, deadline=None)
def test_stretches_give_the_same_bits_as_the_whole(cuts):
    whole = evaluate.evaluate_range(SWEEP, 0, 40)
    ends = [0, *sorted(cuts), 40]
    parts = [evaluate.evaluate_range(SWEEP, a, b) for a, b in pairwise(ends)]
    for name, values in whole.items():
        joined = np.concatenate([part[name] for part in parts])
        if values.dtype == object:
            assert joined.tolist() == values.tolist()
        else:
            assert joined.tobytes() == values.tobytes(), name


def test_no_good_design_at_all():
    sweep = sweep_from_mapping(
        {
            "design": "hyperleg",
            "axes": {"foot.ball_length": {"values": [0.58, 0.59, 0.6]}},
            "set": {"thigh.length": 0.2},
        }
    )
    rows = evaluate.evaluate_range(sweep, 0, 3)
    assert (rows["rejected"] != "").all()
    assert np.isnan(rows["total_mass"]).all()


def counted(sweep, monkeypatch):
    """How often a batch of designs is built, as a list that grows."""
    calls = []
    original = type(sweep).design
    monkeypatch.setattr(
        type(sweep),
        "design",
        lambda self, part, variant: calls.append(1) or original(self, part, variant),
    )
    return calls


MANY = {
    "design": "hyperleg",
    "sampling": "random",
    "count": 1024,
    "set": {"thigh.length": 0.28},
    "measures": ["total_mass"],
}
TWO_WAYS_TO_FAIL = {
    "foot.ball_length": {"low": 0.1, "high": 0.6},
    "foot.mass": {"low": 0.03, "high": 0.7},
}


def test_refused_designs_cost_a_batch_a_reason_not_one_each(monkeypatch):
    sweep = sweep_from_mapping(MANY | {"axes": TWO_WAYS_TO_FAIL})
    calls = counted(sweep, monkeypatch)
    _, reasons = evaluate.evaluate_samples(sweep, sweep.samples(), "toe")
    found = {
        reason.split(":")[0]: int((reasons == reason).sum()) for reason in set(reasons) if reason
    }
    assert min(found["foot.ball_length"], found["foot.cross_mass"]) > 20
    assert len(calls) <= 3


def test_halving_finds_the_same_where_errors_do_not_say_which(monkeypatch):
    sweep = sweep_from_mapping(MANY | {"count": 64, "axes": TWO_WAYS_TO_FAIL})
    values, reasons = evaluate.evaluate_samples(sweep, sweep.samples(), "toe")
    monkeypatch.setattr(evaluate, "_refused", lambda error, count: None)
    halved_values, halved_reasons = evaluate.evaluate_samples(sweep, sweep.samples(), "toe")
    assert halved_reasons.tolist() == reasons.tolist()
    assert halved_values.tobytes() == values.tobytes()


def test_halving_tries_only_the_bad_designs_alone(monkeypatch):
    """Among many good designs one bad one costs a few more batches, not one for each design."""
    sweep = sweep_from_mapping(MANY | {"axes": {"foot.ball_length": {"low": 0.1, "high": 0.2}}})
    samples = {"foot.ball_length": sweep.samples()["foot.ball_length"].copy()}
    samples["foot.ball_length"][700] = 0.6
    monkeypatch.setattr(evaluate, "_refused", lambda error, count: None)
    calls = counted(sweep, monkeypatch)
    _, reasons = evaluate.evaluate_samples(sweep, samples, "toe")
    assert np.flatnonzero(reasons != "").tolist() == [700]
    assert len(calls) <= 2 * 10 + 1


REFUSALS = {
    "joints.knee.lower_deg": {"joints.knee.lower_deg": [0.0, 170.0, 0.0]},
    "foot.gyration": {
        "foot.gyration": np.array([[0.03, 0.05, 0.056], [0.001, 0.002, 0.4], [0.03, 0.05, 0.056]])
    },
    "thigh.mass": {"thigh.mass": [5.71, 1.0, 5.71]},
}


@pytest.mark.parametrize("field", REFUSALS)
def test_errors_of_a_batch_say_which_designs_are_wrong(field):
    with pytest.raises(InputError) as caught:
        SWEEP.base.with_values({path: np.asarray(v) for path, v in REFUSALS[field].items()})
    assert caught.value.field == field
    assert np.asarray(caught.value.bad).tolist() == [False, True, False]
