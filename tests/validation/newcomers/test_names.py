"""The newcomers' words for what is wrong are those of the catalogue, where it has them."""

from __future__ import annotations

import pytest

from hyperleg_design.gap.effects import EFFECTS as CATALOGUE
from hyperleg_design.validation.newcomers.names import ALIKE, EFFECTS, SIZES, fault_of


def test_effects_and_what_logs_cannot_tell_from_them_are_in_the_catalogue():
    assert set(EFFECTS.values()) <= set(CATALOGUE)
    assert set(ALIKE) | set(SIZES) <= set(EFFECTS)
    for what, others in ALIKE.items():
        assert set(others) <= set(CATALOGUE) - {EFFECTS[what]}


@pytest.mark.parametrize("what", sorted(SIZES))
def test_sizes_are_parameters_of_the_effect(what):
    fault = fault_of(what, ("elbow",), 2)
    assert fault.parameters == {SIZES[what]: 2.0}
    assert set(fault.parameters) <= {p.name for p in CATALOGUE[fault.effect].parameters}


def test_a_fault_has_its_equivalents_in_its_own_place():
    fault = fault_of("weak", ("knee", "motor"), 0.8)
    assert (fault.effect, fault.places) == ("torque_constant", ("knee", "motor"))
    assert fault.equivalents == tuple(
        (effect, ("knee", "motor")) for effect in ("transmission_ratio", "controller_gain")
    )


def test_a_delay_is_the_whole_robots_and_known_values_replace_the_size():
    assert fault_of("late", ("knee",), 0.01).places == ("robot",)
    assert fault_of("dry", ("knee",), 1.0, {"torque": 0.7}).parameters == {"torque": 0.7}
    assert fault_of("rough", ("knee",), 2.5).parameters == {}


def test_what_the_catalogue_lacks_has_no_place():
    fault = fault_of("lost commands", ("knee",), 0.3)
    assert (fault.effect, fault.listed, fault.places) == ("lost_commands", False, ())
