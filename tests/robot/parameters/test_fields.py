"""Fields of parameters: the rule of a leaf, its default, and which fields are sections."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, field

import numpy as np
import pytest

from hyperleg_design.robot.parameters import fields


@dataclass(frozen=True)
class Inner:
    angle: float = fields.number("rad", -1, 1, default=0.5)


@dataclass(frozen=True, kw_only=True)
class Outer:
    place: np.ndarray = fields.number("m", -5, 5, size=3, default=(0.0, 1.0, 2.0))
    mass: float = fields.number("kg", 0)
    colour: str = fields.text("red", "green", varies=True)
    on: bool = fields.flag(default=True)
    inner: Inner = field(default_factory=Inner)
    name: str = "outer"


BY_NAME = {f.name: f for f in dataclasses.fields(Outer)}


def test_rules_say_what_a_leaf_may_hold():
    assert fields.rule_of(BY_NAME["place"]) == fields.Rule("number", "m", -5, 5, 3)
    assert fields.rule_of(BY_NAME["mass"]) == fields.Rule("number", "kg", 0, math.inf)
    assert fields.rule_of(BY_NAME["colour"]).choices == ("red", "green")
    assert fields.rule_of(BY_NAME["on"]).kind == "flag"


def test_numbers_vary_over_a_batch_and_flags_never():
    varies = {name: fields.rule_of(BY_NAME[name]).varies for name in ("mass", "colour", "on")}
    assert varies == {"mass": True, "colour": True, "on": False}
    (text,) = dataclasses.fields(dataclasses.make_dataclass("T", [("t", str, fields.text())]))
    assert not fields.rule_of(text).varies


def test_leaves_and_sections_are_told_apart():
    leaves = {name for name, f in BY_NAME.items() if fields.is_leaf(f)}
    assert leaves == {"place", "mass", "colour", "on"}
    assert fields.section_types(Outer) == {"inner": Inner}
    assert fields.section_types(Outer) is fields.section_types(Outer)
    with pytest.raises(TypeError):
        fields.section_types(Outer)["other"] = Inner  # shared by all who ask


def test_defaults_of_vectors_are_arrays_and_a_field_without_default_is_required():
    made = Outer(mass=1.0, colour="red")
    np.testing.assert_array_equal(made.place, [0.0, 1.0, 2.0])
    assert made.place.dtype == float
    assert made.on
    with pytest.raises(TypeError, match="mass"):
        Outer(colour="red")
