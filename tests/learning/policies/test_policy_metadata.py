"""A policy carries its training's description, and the rest of a description stays out."""

from __future__ import annotations

import pytest

from hyperleg_design.learning.policies.policy_metadata import KEYS, policy_metadata

DESCRIPTION = {key: f"the {key}" for key in KEYS} | {"seed": 7, "overlay": None, "machine": "mine"}


def metadata(**changes):
    return policy_metadata(
        DESCRIPTION | changes, steps=96, columns=("a", "b"), joints=("hip", "knee"), designs=None
    )


def test_numbers_are_texts_and_names_are_lists():
    found = metadata()
    assert (found["seed"], found["steps"]) == ("7", "96")
    assert (found["columns"], found["joints"]) == (["a", "b"], ["hip", "knee"])
    assert found["task"] == "the task"


def test_what_a_training_does_not_have_is_left_out():
    assert not {"overlay", "designs", "machine", "design_ranges"} & metadata().keys()
    assert metadata(overlay={"effects": []})["overlay"] == {"effects": []}


def test_a_description_that_lacks_a_part_is_an_error():
    with pytest.raises(KeyError, match="commit"):
        policy_metadata(
            {key: value for key, value in DESCRIPTION.items() if key != "commit"},
            steps=1,
            columns=(),
            joints=(),
            designs=None,
        )
