"""Names and sizes of what is wrong with plants, against the catalogue of the diagnosis."""

from __future__ import annotations

import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.validation.blind.wrong import CATALOGUE, ODDITIES, SIZES, WALKING_ONLY, Wrong


def test_the_catalogue_written_out_here_is_that_of_the_diagnosis():
    assert set(CATALOGUE) == set(EFFECTS)
    assert len(set(CATALOGUE)) == len(CATALOGUE)
    assert not set(ODDITIES) & set(EFFECTS)
    assert set(WALKING_ONLY) < set(CATALOGUE)


def test_every_effect_that_a_rig_can_show_has_a_range_of_sizes():
    assert set(SIZES) == (set(CATALOGUE) - set(WALKING_ONLY)) | set(ODDITIES)
    for size in SIZES.values():
        assert 0 < size.smallest < size.largest
        assert size.unit


@pytest.mark.parametrize(("effect", "listed"), [("payload", True), ("fluid_drag", False)])
def test_oddities_are_not_listed(effect, listed):
    assert Wrong(effect, "elbow", 0.1, {}).listed == listed
