from collections import Counter

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.validation.blind.plan import KINDS, ONE_JOINT_CANNOT, plan_cases
from hyperleg_design.validation.blind.wrong import CATALOGUE, ODDITIES, WALKING_ONLY


def test_the_same_seed_draws_the_same_cases():
    assert plan_cases(60, 3) == plan_cases(60, 3)
    assert plan_cases(60, 3) != plan_cases(60, 4)


def test_proportions_and_rounds():
    plans = plan_cases(240, 1)
    kinds = Counter(p.kind for p in plans)
    for kind, share in KINDS.items():
        assert abs(kinds[kind] - 240 * share) <= 1
    assert {e for p in plans for e in p.effects if p.kind != "outside"} == set(CATALOGUE)
    singles = Counter(p.effects[0] for p in plans if p.kind == "single")
    assert len(singles) >= 22
    assert max(singles.values()) <= 12
    assert {p.effects[0] for p in plans if p.kind == "outside"} <= set(ODDITIES)
    assert all(len(set(p.effects)) == 2 for p in plans if p.kind == "compound")
    assert all(not p.effects for p in plans if p.kind == "null")
    assert all(p.plant == "walking" for p in plans if set(p.effects) & set(WALKING_ONLY))
    assert not any(p.robot == "servo" and set(p.effects) & set(ONE_JOINT_CANNOT) for p in plans)
    assert all(1.0 <= m <= 5.0 for p in plans for m in p.multiples)


def test_plants_can_be_kept_apart():
    assert {p.plant for p in plan_cases(30, 0, plants=("other",))} == {"other"}
    with pytest.raises(InputError, match=r"moon.*choose of"):
        plan_cases(3, 0, plants=("moon",))
    with pytest.raises(InputError, match="cases = 0"):
        plan_cases(0, 0)
