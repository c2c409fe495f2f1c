import pytest

from hyperleg_design.evaluation.policy import load_policy, standing
from hyperleg_design.evaluation.training_fit import training_fit

RANGES = {"toe.mass": {"low": 0.05, "high": 1.0}, "thigh.length": {"low": 0.3, "high": 0.4}}


def test_a_policy_is_a_specialist_on_its_own_design_and_zero_shot_on_others():
    policy = load_policy("walk_upright-toe-0")
    assert training_fit(policy, policy.design).text() == "specialist"
    heavy = training_fit(policy, policy.design.with_values({"toe.mass": 0.5}))
    assert heavy.kind == "zero-shot"
    assert heavy.outside == ("toe.mass",)
    trained = float(policy.design.toe.mass)
    change = f"toe.mass {trained:.4g} -> 0.5 kg"
    assert heavy.text() == f"zero-shot, outside the trained range: {change}"


def test_a_callable_says_nothing():
    design = load_policy("walk_upright-toe-0").design
    assert training_fit(standing(14), design).kind == "unknown"


@pytest.mark.parametrize(
    ("values", "kind", "outside"),
    [
        ({}, "conditioned", ()),
        ({"toe.mass": 0.9, "thigh.length": 0.35}, "conditioned", ()),
        ({"toe.mass": 1.2, "thigh.length": 0.35}, "zero-shot", ("toe.mass",)),
        ({"toe.mass": 0.9, "shank.length": 0.3}, "zero-shot", ("shank.length",)),
    ],
)
def test_a_conditioned_policy_is_one_inside_its_ranges_only(values, kind, outside):
    policy = load_policy("walk_upright-toe-0")
    policy.metadata = {**policy.metadata, "design_ranges": RANGES}
    found = training_fit(policy, policy.design.with_values(values))
    assert (found.kind, found.outside) == (kind, outside)
