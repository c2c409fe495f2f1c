"""A whole trial, small: made in a process of its own, sealed, diagnosed by what users run, scored
once. Servos, as they are quick.
"""

import pytest

from hyperleg_design.validation.blind.score import open_key, score
from hyperleg_design.validation.blind.trial import diagnose_trial, make_trial

SEED = 13259


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    folder = tmp_path_factory.mktemp("small") / "trial"
    make_trial(4, SEED, folder, plants=("rig", "other"), workers=2)
    diagnose_trial(folder, workers=2)
    return folder


@pytest.mark.slow
def test_friction_and_a_gain_are_named_a_healthy_servo_is_not_blamed_and_drag_is_not_in_the_catalogue(  # noqa: E501
    trial,
):
    found = score(trial)
    truths = {t["case"]: t for t in open_key(trial)}
    assert {t["robot"] for t in truths.values()} == {"servo"}
    assert sorted(t["kind"] for t in truths.values()) == ["null", "outside", "single", "single"]
    assert found.diagnosed == 4
    assert [(miss.case, miss.said) for miss in found.misses] == []
