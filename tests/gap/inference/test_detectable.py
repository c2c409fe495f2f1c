"""The least sizes that logs would have shown, against causes of these sizes in the residual."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.detectable import _choices, _smallest, detectable, usual_shape
from hyperleg_design.gap.inference.hypotheses.cause_prior import usual_error


@pytest.fixture(scope="module")
def sizes(search):
    return detectable(search)


@pytest.fixture(scope="module")
def exact(search):
    """The same search of a robot that nobody calibrates wrongly."""
    found = type(search).__new__(type(search))
    found.__dict__ |= vars(search) | {"evidence": replace(search.evidence, usual={})}
    return found


def test_a_cause_of_this_size_is_named_nine_times_in_ten(search, exact):
    evidence, scales = search.evidence, search.fits.null.scales
    for one in detectable(exact):
        cause, *_ = search.traces[one.effect, one.location, False]
        unit = cause.columns[0] / cause.usual[0] * evidence.weight
        mean = one.change * unit
        # the log likelihood over nothing's of the best size is z^2 / 2, z normal about its mean
        information = 0.0
        for channel, own in zip(evidence.channels, scales, strict=True):
            cross, square = channel.crossed(mean[None])
            information += channel.reduced(own, cross, square)[1, 1]
        odds = np.log(2 * 2 / 0.5)
        assert norm.sf(np.sqrt(2 * odds) - np.sqrt(information)) == pytest.approx(0.9, abs=1e-3)


def test_a_cause_of_this_size_is_nine_times_in_ten_larger_than_a_usual_error(search, sizes, exact):
    least = {(one.effect, one.location): one.change for one in detectable(exact)}
    larger = 0
    for one in sizes:
        key = one.effect, one.location
        usual = usual_error(search.evidence, search.rules, (*key, 0))
        cause, *_ = search.traces[*key, False]
        information = search.proposer.information((*key, False), search.fits.null.scales)[0]
        spread = search.rules.posterior.interval * cause.usual[0] / np.sqrt(information)
        assert usual > 0
        if one.change > least[key]:
            larger += 1
            assert norm.cdf((one.change - usual) / spread) == pytest.approx(0.9, abs=1e-3)
        else:
            assert norm.cdf((one.change - usual) / spread) >= 0.9 - 1e-3
    assert larger


def test_each_effect_at_each_place_has_one_size_within_its_bounds(search, sizes):
    assert {(one.effect, one.location) for one in sizes} == {name[:2] for name in search.traces}
    subject = search.evidence.signals[0].subject
    for one in sizes:
        effect = EFFECTS[one.effect]
        (parameter,) = (p for p in effect.parameters if p.name == one.parameter)
        assert one.unit == parameter.unit
        low, high = effect.bounds(one.location, subject)[:, 0]
        assert 0 < one.change <= max(parameter.null - low, high - parameter.null)


def test_what_is_wrong_is_larger_than_what_would_have_been_named(sizes):
    least = {(one.effect, one.location): one.change for one in sizes}
    assert least["viscous_friction", "knee"] < 0.3
    assert least["coulomb_friction", "hip"] < 0.8


def test_a_gap_that_causes_explain_hides_nothing(search, sizes):
    """Beside no cause, the friction at the knee counts as discrepancy there."""
    explained = search.settled(search.result().best).best
    assert ("viscous_friction", "knee", False) in explained.names
    mended = {(one.effect, one.location): one.change for one in detectable(search, explained)}
    for one in sizes:
        if one.location == "knee":
            assert mended[one.effect, one.location] < 0.9 * one.change
    place = [cause.name for cause in explained.causes].index(("viscous_friction", "knee"))
    assert mended["viscous_friction", "knee"] < explained.values(place)[0]


def test_less_likely_causes_must_be_larger(search, exact):
    doubtful = type(search).__new__(type(search))
    cause = replace(search.rules.cause, probability=0.01)
    doubtful.__dict__ |= vars(exact) | {"rules": replace(search.rules, cause=cause)}
    for one, other in zip(detectable(exact), detectable(doubtful), strict=True):
        assert other.change > one.change


def test_the_answers_file_holds_all_fields(sizes):
    assert sizes[0].mapping() == {
        "effect": sizes[0].effect,
        "location": sizes[0].location,
        "parameter": sizes[0].parameter,
        "change": sizes[0].change,
        "unit": sizes[0].unit,
    }


def test_what_logs_show_is_shown_whichever_choice_holds():
    """Of play, the smallest angle of each side that encoders may sit on, and of each friction."""
    effect = EFFECTS["backlash"]
    values = np.array(
        [[0.01, 0.0, 1.0, 0.0], [0.003, 0.0, 1.0, 0.0], [0.03, 1.0, 1.0, 0.0], [0.0, 1.0, 1.0, 1.0]]
    )
    change = np.where(values[:, 0] > 0, values[:, 0], np.inf)
    assert _smallest(change, _choices(effect, values)) == [1, 2]
    assert _smallest(change, np.zeros((4, 0))) == [1]


def test_a_load_of_grams_far_from_its_link_is_no_measure_of_what_shows(search):
    subject, effect = search.evidence.signals[0].subject, EFFECTS["payload"]
    place = effect.locations(subject)[-1]
    shown = effect.example(place, subject)
    far = np.array([0.001, 1.0, 1.0, -1.0, 0.0])
    told = usual_shape(effect, place, subject, np.array([far, shown, 0.1 * shown]))
    assert told.tolist() == [False, True, False]
    half = np.r_[0.5 * shown[0], shown[1:]]
    assert usual_shape(effect, place, subject, half[None]).all()
