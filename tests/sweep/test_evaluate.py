from itertools import pairwise

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.sweep import evaluate, measures
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
    for reason, ball in zip(rows["rejected"][rejected], rows["foot.ball_length"][rejected], strict=True):
        assert reason == f"foot.ball_length = {float(f'{ball:.6g}')}: makes the foot longer than the leg; lengths are metres"
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
        one = {name: values[rows["sample"][row] : rows["sample"][row] + 1] for name, values in samples.items()}
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
    sweep = sweep_from_mapping({"design": "hyperleg", "axes": {"foot.ball_length": {"values": [0.58, 0.59, 0.6]}}, "set": {"thigh.length": 0.2}})
    rows = evaluate.evaluate_range(sweep, 0, 3)
    assert (rows["rejected"] != "").all()
    assert np.isnan(rows["total_mass"]).all()


def test_only_the_bad_designs_are_tried_alone(monkeypatch):
    """Among many good designs one bad one costs a few more batches, not one for each design."""
    count = 1024
    sweep = sweep_from_mapping(
        {
            "design": "hyperleg",
            "sampling": "random",
            "count": count,
            "axes": {"foot.ball_length": {"low": 0.1, "high": 0.2}},
            "set": {"thigh.length": 0.2},
        }
    )
    samples = {"foot.ball_length": sweep.samples()["foot.ball_length"].copy()}
    samples["foot.ball_length"][700] = 0.6
    calls = []
    original = type(sweep).design
    monkeypatch.setattr(type(sweep), "design", lambda self, part, variant: calls.append(1) or original(self, part, variant))
    _, reasons = evaluate.evaluate_samples(sweep, samples, "toe")
    assert np.flatnonzero(reasons != "").tolist() == [700]
    assert len(calls) <= 2 * 10 + 1
