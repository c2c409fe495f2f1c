"""References that differ from one another, on logs of a small robot in plain MuJoCo."""

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.hypotheses.reference_differences import differences
from hyperleg_design.gap.inference.hypotheses.search import Search
from hyperleg_design.gap.inference.rules import InferenceRules

PLACES = [
    (effect, joint)
    for effect in ("viscous_friction", "coulomb_friction", "encoder_offset")
    for joint in ("hip", "knee")
]


def searched(robot, *kinds):
    """Search on one healthy log under test and references of these kinds."""
    references = [diagnosed.run(kind, seed) for seed, kind in enumerate(kinds, 2)]
    evidence = diagnosed.evidence(
        robot, diagnosed.run("healthy", 0, session="today"), references=references
    )
    search = Search(evidence, InferenceRules(), PLACES)
    return search, differences(search, search.result())


@pytest.fixture(scope="module")
def dry(robot_files):
    return searched(robot_files["coupled"], "healthy", "dry", "healthy")


def test_the_odd_reference_is_named_with_effect_place_and_size(dry):
    _, found = dry
    first = found[0]
    assert (first.log, first.reference) == ("dry_3", 1)
    assert (first.cause.effect, first.cause.location) == ("coulomb_friction", "hip")
    assert first.values[0] == pytest.approx(0.8, rel=0.2)
    assert abs(first.values[0] - 0.8) < 3 * first.deviation[0]
    assert first.odds > 10


def test_without_what_set_it_apart_a_reference_is_like_the_others(dry):
    search, found = dry
    signals = search.evidence.references
    mended = found[0].taken_out(signals)
    assert mended[0] is signals[0]
    assert mended[2] is signals[2]

    def size(one):
        return np.sqrt(np.nanmean(one.residual["motion"][one.valid, 0] ** 2))

    assert size(signals[1]) > 3 * size(signals[0])
    assert size(mended[1]) < 1.5 * size(signals[0])


def test_references_that_are_alike_do_not_differ_however_wrong_the_model_is(robot_files):
    assert searched(robot_files["coupled"], "healthy", "healthy")[1] == []
    assert searched(robot_files["coupled"], "dry", "dry", "dry")[1] == []


@pytest.mark.parametrize("kinds", [(), ("dry",)])
def test_one_reference_has_nothing_to_differ_from(robot_files, kinds):
    assert searched(robot_files["coupled"], *kinds)[1] == []
