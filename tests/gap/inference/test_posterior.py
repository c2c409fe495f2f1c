from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.hypotheses.hypothesis import EVERYWHERE, Candidate, Hypothesis
from hyperleg_design.gap.inference.hypotheses.search import Result
from hyperleg_design.gap.inference.posterior import changes_first, posterior_of, untold
from hyperleg_design.gap.inference.rules import InferenceRules

RULES = InferenceRules()
HEALTHY = Scales(np.ones(1), 0.0, np.log(0.3))
BENT = Scales(np.ones(1), np.log(30.0), np.log(0.3))


def cause(effect, place, standing=False):
    return SimpleNamespace(
        effect=effect,
        location=place,
        standing=standing,
        nulls=np.zeros(1),
        usual=np.ones(1),
        shape=np.zeros(1, bool),
        low=np.full(1, -9.0),
        high=np.full(1, 9.0),
        trace=lambda theta: theta,
    )


def hypothesis(score, *names, scales=HEALTHY):
    candidates = tuple(Candidate(*name[:2], (cause(*name),)) for name in names)
    count = len(names)
    return Hypothesis(candidates, np.arange(count, 0.0, -1), np.eye(count), (scales,), score, 0.0)


def quiet(noise, rules):
    """Log densities of noise that is a healthy robot's."""
    return 0.0, -9.0


def answer(*hypotheses, closed=1.0, usual=None, references=(), alone=None, ordered=True):
    """`alone`: what each cause closes, by its size."""
    ranked = tuple(sorted(hypotheses, key=lambda one: -one.score) if ordered else hypotheses)
    nothing_tested = {
        "bands_tested": np.zeros(0, int),
        "usual_noise": lambda noise, rules: np.zeros(0),
    }
    channels = (SimpleNamespace(referenced=False, noisy=quiet, **nothing_tested),)
    evidence = SimpleNamespace(channels=channels, references=references, usual=usual or {})

    def closed_by(trace, *, standing):
        return 1.0 if alone is None else alone[float(trace[0])]

    size = SimpleNamespace(closed=closed, closed_by=closed_by)
    return posterior_of(Result(ranked, ()), evidence, size, RULES)


def test_nothing_is_none():
    found = answer(hypothesis(0.0), hypothesis(-4.0, ("a", "x")))
    assert found.verdict == "none"
    assert 0 < found.probability["a", "x", False] < 0.5


def test_a_cause_far_ahead_is_explained():
    found = answer(hypothesis(0.0), hypothesis(30.0, ("a", "x")), hypothesis(10.0, ("b", "x")))
    assert found.verdict == "explained"
    assert found.probability["a", "x", False] == RULES.posterior.most_certain_alone
    assert found.closed == pytest.approx(1.0)
    assert found.remainder == 0.0
    assert [candidate.name for _, candidate in found.rivals] == [("b", "x", False)]


def test_references_make_an_answer_more_certain():
    name = "coulomb_friction", "x"
    sure = hypothesis(0.0), hypothesis(30.0, name)
    found = answer(*sure, references=(SimpleNamespace(),))
    assert found.probability[*name, False] == RULES.posterior.most_certain
    assert RULES.posterior.most_certain > RULES.posterior.most_certain_alone


def test_rivals_as_probable_make_it_ambiguous():
    found = answer(hypothesis(0.0), hypothesis(30.0, ("a", "x")), hypothesis(29.5, ("b", "x")))
    assert found.verdict == "ambiguous"
    assert found.alike == ((("b", "x", False),),)


def test_rivals_stand_in_the_place_of_one_of_several():
    found = answer(
        hypothesis(0.0),
        hypothesis(30.0, ("a", "x"), ("c", "y")),
        hypothesis(29.5, ("b", "x"), ("c", "y")),
        hypothesis(12.0, ("c", "y")),
    )
    assert found.verdict == "ambiguous"
    sets = dict(
        zip((found.hypothesis.candidates[i].name for i in found.order), found.alike, strict=True)
    )
    assert sets == {("a", "x", False): (("b", "x", False),), ("c", "y", False): ()}


@pytest.mark.parametrize(("share", "named"), [(0.02, 1), (0.21, 2)])
def test_what_closes_next_to_nothing_beside_another_is_no_cause(share, named):
    both = hypothesis(40.0, ("a", "x"), ("b", "y"))
    found = answer(hypothesis(0.0), both, alone={2.0: 1.0, 1.0: share})
    assert (found.verdict, len(found.order)) == ("explained", named)
    assert found.order[0] == 0
    assert found.minor == ((1,) if named == 1 else ())


def test_what_is_less_probable_than_not_beside_another_is_no_cause():
    both = hypothesis(40.0, ("a", "x"), ("b", "y"))
    others = [hypothesis(37.2, ("a", "x"), (name, "z")) for name in "cdefgh"]
    found = answer(hypothesis(0.0), both, *others)
    assert found.probability["b", "y", False] < RULES.posterior.likely
    assert [found.hypothesis.candidates[i].name[0] for i in found.order] == ["a"]
    assert len(found.minor) == 1


def test_what_cannot_be_told_apart_is_as_probable_as_all_of_it():
    both = hypothesis(40.0, ("a", "x"), ("b", "y"))
    others = [hypothesis(39.8, ("a", "x"), (name, "y")) for name in "cde"]
    found = answer(hypothesis(0.0), both, *others)
    assert found.probability["b", "y", False] < RULES.posterior.likely
    assert (len(found.order), found.minor) == (2, ())


def test_of_causes_that_all_close_little_each_is_named():
    both = hypothesis(40.0, ("a", "x"), ("b", "y"))
    found = answer(hypothesis(0.0), both, alone={2.0: 0.05, 1.0: 0.02})
    assert (len(found.order), found.minor) == (2, ())


def test_an_effect_at_all_places_closes_what_it_closes_at_one_of_them():
    everywhere = Candidate("a", EVERYWHERE, (cause("a", "x"), cause("a", "y")))
    little = Candidate("b", "z", (cause("b", "z"),))
    both = Hypothesis(
        (everywhere, little), np.array([3.0, 2.0, 1.0]), np.eye(3), (HEALTHY,), 40.0, 0.0
    )
    found = answer(hypothesis(0.0), both, alone={3.0: 0.02, 2.0: 0.9, 1.0: 0.03})
    assert [found.hypothesis.candidates[i].effect for i in found.order] == ["a"]
    assert [found.hypothesis.candidates[i].effect for i in found.minor] == ["b"]


def test_what_stands_in_the_references_is_no_change():
    found = answer(hypothesis(0.0), hypothesis(30.0, ("a", "x", True)))
    assert found.verdict == "none"
    assert not found.order
    assert found.standing == (0,)


@pytest.mark.parametrize(("behind", "verdict"), [(1.0, "explained"), (4.0, "none")])
def test_what_references_do_not_show_is_a_cause_under_test(behind, verdict):
    """References that show nothing of a cause leave it as probable in all logs as under test."""
    standing, change = ("a", "x", True), ("a", "x")
    ranked = hypothesis(30.0, standing), hypothesis(30.0 - behind, change), hypothesis(0.0)
    first = changes_first(Result(ranked, ()), RULES)
    assert len(first.hypotheses) == 3
    assert untold(first) == ({standing} if verdict == "explained" else set())
    found = answer(*first.hypotheses, ordered=False)
    assert found.verdict == verdict
    if verdict == "explained":
        assert found.probability["a", "x", False] == RULES.posterior.most_certain_alone
        assert not found.standing


def test_a_change_beside_what_stands_is_explained():
    best = hypothesis(40.0, ("a", "x", True), ("a", "x"))
    found = answer(hypothesis(0.0), best, hypothesis(30.0, ("a", "x", True)))
    assert found.verdict == "explained"
    assert (found.order, found.standing) == ((1,), (0,))
    assert not found.rivals


def test_something_unlisted_alone_is_unknown():
    found = answer(hypothesis(0.0, scales=BENT), closed=0.0)
    assert found.verdict == "unknown"
    assert found.remainder == pytest.approx(1.0)


@pytest.mark.parametrize(("closed", "verdict"), [(0.3, "unknown"), (0.75, "explained")])
def test_what_is_beside_something_unlisted_must_close_the_main_part(closed, verdict):
    best = hypothesis(30.0, ("a", "x"), scales=BENT)
    found = answer(hypothesis(0.0), best, closed=closed)
    assert found.verdict == verdict
    assert found.remainder == pytest.approx(1 - closed)
    assert found.probability["a", "x", False] <= 1 - found.remainder


def test_an_effect_that_is_not_listed_is_no_cause_but_a_remainder():
    best = hypothesis(30.0, ("leaning_vertical", "robot"))
    found = answer(hypothesis(0.0), best, hypothesis(20.0, ("a", "x")), closed=0.0)
    assert (found.verdict, found.order, found.odd) == ("unknown", (), (0,))
    assert found.remainder == pytest.approx(1.0)
    assert [candidate.name for _, candidate in found.rivals] == [("a", "x", False)]


def test_an_effect_that_is_not_listed_may_stand_in_the_references():
    found = answer(hypothesis(0.0), hypothesis(30.0, ("leaning_vertical", "robot", True)))
    assert (found.verdict, found.standing, found.odd) == ("none", (), (0,))


def test_without_anything_unlisted_any_part_is_explained():
    found = answer(hypothesis(0.0), hypothesis(30.0, ("a", "x")), closed=0.3)
    assert (found.verdict, found.remainder) == ("explained", 0.0)


def test_what_is_more_probably_a_usual_error_than_not_is_no_fault():
    best = hypothesis(30.0, ("a", "x"), ("b", "y"))  # sizes 2 and 1, deviations 1
    found = answer(hypothesis(0.0), best, usual={("b", "y", 0): 0.5})  # 1.5 is usual
    assert [found.hypothesis.candidates[i].name for i in found.order] == [("a", "x", False)]
    usual = {("a", "x", 0): 1.0, ("b", "y", 0): 0.5}
    assert answer(hypothesis(0.0), best, usual=usual).verdict == "none"
    usual = {("a", "x", 0): 0.6, ("b", "y", 0): 0.3}
    assert len(answer(hypothesis(0.0), best, usual=usual).order) == 2
