"""An effect that lacks what a diagnosis or a simulation asks it for is refused by the catalogue."""

from __future__ import annotations

import sys

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap import effects
from hyperleg_design.gap.effects.complete import check_complete

MODULE = """
from hyperleg_design.gap.effects.joints.viscous_friction import ViscousFriction
from hyperleg_design.gap.effects.kinds import JointTorque


class Sticky(JointTorque):
    identifier = "sticky"
    summary = "grows with the speed"
    parameters = ViscousFriction.parameters
    linear = True
    needs = ViscousFriction.needs

    def _torque(self, signals, joint, *values, **named):
        return values[0] * signals.velocity[:, joint]
"""
HOOKS = """
    def alteration(self, location, values, subject):
        return ViscousFriction().alteration(location, values, subject)
"""


@pytest.fixture
def catalogue(tmp_path, monkeypatch):
    """Read the catalogue again, with one more module."""

    def read(text):
        (tmp_path / "sticky.py").write_text(text)
        monkeypatch.setattr(effects, "__path__", [*effects.__path__, str(tmp_path)])
        try:
            return effects._discovered_effects()
        finally:
            sys.modules.pop("hyperleg_design.gap.effects.sticky", None)
            vars(effects).pop("sticky", None)

    return read


def test_an_effect_without_hooks_is_refused_by_name_as_it_enters_the_catalogue(catalogue):
    with pytest.raises(InputError, match=r"Sticky \(sticky\): hooks: is missing") as error:
        catalogue(MODULE)
    assert "or override alteration()" in str(error.value)


def test_an_effect_with_an_alteration_of_its_own_needs_no_hooks(catalogue):
    assert catalogue(MODULE + HOOKS).keys() - effects.WEIGHED.keys() == {"sticky"}


@pytest.mark.parametrize("field", ["identifier", "summary", "parameters", "needs"])
def test_each_field_that_is_asked_for_is_named(catalogue, field):
    rows = [row for row in MODULE.splitlines() if not row.strip().startswith(f"{field} =")]
    with pytest.raises(InputError, match=rf"Sticky.*: {field}: is missing"):
        catalogue("\n".join(rows) + "\n" + HOOKS)


def test_every_effect_of_the_catalogue_passes():
    for effect in effects.WEIGHED.values():
        check_complete(type(effect))
