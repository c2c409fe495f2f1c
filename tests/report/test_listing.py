from __future__ import annotations

import json

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.report.listing import KINDS, listing, listing_text
from hyperleg_design.robot.design import Design
from hyperleg_design.robot.parameters import values as parameters


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_listed_for_people_and_programs(kind):
    found = listing(kind)
    assert found[kind]
    json.dumps(found, allow_nan=False)
    assert next(iter(found[kind])) in listing_text(found)


def test_every_parameter_is_listed_with_a_label():
    found = listing("parameters")["parameters"]
    assert set(found) == set(parameters.rules(Design))
    assert all(entry["label"] in parameters.LABELS for entry in found.values())


def test_parameters_of_any_design_are_listed():
    found = listing("parameters", "teaching_leg")["parameters"]
    assert found["actuators.knee.gear"]["value"] == 6.0
    assert found["joints.knee.stiffness"]["unit"] == "Nm/rad"


def test_long_descriptions_are_wrapped_to_a_terminal_and_lose_no_word():
    found = listing("presets")
    wide, narrow = listing_text(found), listing_text(found, 80)
    assert max(map(len, narrow.splitlines())) <= 80
    dashes = str.maketrans("", "", "-")
    assert narrow.translate(dashes).split() == wide.translate(dashes).split()


def test_an_unknown_kind_names_the_known_ones():
    with pytest.raises(InputError, match="designs"):
        listing("robots")
