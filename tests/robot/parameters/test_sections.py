from __future__ import annotations

import dataclasses

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.design import Design
from hyperleg_design.robot.parameters import sections
from hyperleg_design.robot.parameters import values as parameters

CLASSES = [c for c in vars(sections).values() if dataclasses.is_dataclass(c)]


def test_numbers_have_units_or_are_ratios_and_have_bounds():
    for path, rule in parameters.rules(Design).items():
        if rule.kind == "number":
            assert rule.low < rule.high < 1e4, path
            assert path.endswith(("_deg",)) == (rule.unit == "deg"), path


def test_the_papers_robot_has_every_leaf_with_an_origin(hyperleg):
    assert set(hyperleg.origins) == set(parameters.rules(Design))
    assert {origin.label for origin in hyperleg.origins.values()} <= {
        "paper",
        "derived",
        "assumed",
        "vendor",
    }
    for path, origin in hyperleg.origins.items():
        assert origin.source or origin.label == "assumed", path


def test_leaves_lie_well_within_their_bounds(hyperleg):
    """Bounds catch mistakes of unit: a thousand times the paper's value breaks every bound of a
    length or mass.
    """
    for path, rule in parameters.rules(Design).items():
        value = hyperleg[path]
        if rule.unit in ("m", "kg") and not rule.size and value > 0:
            with pytest.raises(InputError, match=r"unit and sign"):
                parameters.checked(value * 1000, rule, "f", path)


@pytest.mark.parametrize("cls", CLASSES, ids=lambda c: c.__name__)
def test_sections_are_frozen(cls):
    assert cls.__dataclass_params__.frozen


def test_a_section_checks_itself():
    with pytest.raises(InputError, match=r"joint: lower_deg"):
        sections.Joint(
            lower_deg=-500, upper_deg=0, coulomb=0, viscous=0, stiffness=0, damping=0, default_deg=0
        )


def test_friction_and_gains_are_not_negative():
    good = {
        "lower_deg": -1,
        "upper_deg": 1,
        "coulomb": 0,
        "viscous": 0,
        "stiffness": 0,
        "damping": 0,
        "default_deg": 0,
    }
    for field in ("coulomb", "viscous", "stiffness", "damping"):
        with pytest.raises(InputError, match=field):
            sections.Joint(**{**good, field: -1e-3})
