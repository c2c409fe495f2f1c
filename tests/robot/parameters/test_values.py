from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.fields import Rule, flag, number, text
from hyperleg_design.robot.parameters.values import Checked, Origin, checked


@dataclass(frozen=True, eq=False, kw_only=True)
class Part(Checked):
    length: Any = number("m", 0, 2)
    com: Any = number("m", -1, 1, size=3, default=(0.0, 0.0, 0.1))
    kind: Any = text("long", "short", default="long")
    motor: Any = text(default="A", varies=True)
    there: Any = flag(default=True)


@dataclass(frozen=True, eq=False, kw_only=True)
class Whole:
    part: Part
    mass: Any = number("kg", 0.1, 10)


LENGTH = Rule("number", "m", 0, 2)
VECTOR = Rule("number", "m", -1, 1, 3)


@pytest.mark.parametrize(
    ("value", "result"),
    [
        (1, 1.0),
        (0.5, 0.5),
        ("1e-3", 1e-3),
        (np.float32(0.5), 0.5),
        (np.int64(2), 2.0),
        (np.array(1.5), 1.5),
    ],
)
def test_numbers_become_floats(value, result):
    found = checked(value, LENGTH, "f", "x")
    assert type(found) is float
    assert found == result


@pytest.mark.parametrize(
    "value",
    [
        None,
        True,
        "long",
        "1 m",
        "",
        [1.0],
        {},
        {"value": 1},
        (),
        float("nan"),
        float("inf"),
        "nan",
        "-inf",
        10**400,
        -1,
        3,
        1j,
        b"x",
        object(),
        np.array([True, False]).tolist(),
        np.array([[1.0]]),
        np.array([]),
        np.array(["a"]),
        np.array([1.0, np.nan]),
        np.array([1.0, 5.0]),
    ],
)
def test_what_is_no_length_is_refused(value):
    with pytest.raises(InputError) as caught:
        checked(value, LENGTH, "file.yaml", "part.length")
    assert "file.yaml: part.length" in str(caught.value)
    assert "number in m" in str(caught.value) or "no designs" in str(caught.value)


@pytest.mark.parametrize(
    "value",
    [
        1.0,
        [1, 2],
        [0, 0, 0, 0],
        [0, 0, 5],
        [0, None, 0],
        [0, True, 0],
        "0 0 0",
        [[0, 0], [0, 0]],
        np.zeros((2, 2, 3)),
        np.zeros((0, 3)),
    ],
)
def test_what_is_no_vector_is_refused(value):
    with pytest.raises(InputError, match=r"part\.com"):
        checked(value, VECTOR, "f", "part.com")


def test_the_value_out_of_bounds_is_named():
    with pytest.raises(InputError, match=r"x = 5\.0.*0 \.\. 2; check unit and sign"):
        checked(np.array([1.0, 5.0, 1.0]), LENGTH, "f", "x")
    with pytest.raises(InputError, match=r"x = 5: "):  # as it was written
        checked(5, LENGTH, "f", "x")


@given(st.floats(0, 2))
def test_every_number_within_bounds_is_kept(value):
    assert checked(value, LENGTH, "f", "x") == value
    assert checked(repr(value), LENGTH, "f", "x") == value


def test_batches_are_copied_and_read_only():
    mine = np.array([0.5, 1.0])
    kept = checked(mine, LENGTH, "f", "x")
    mine[0] = 2.0
    assert kept.tolist() == [0.5, 1.0]
    with pytest.raises(ValueError, match="read-only"):
        kept[0] = 1.0
    assert checked(np.zeros((4, 3)), VECTOR, "f", "x").shape == (4, 3)


def test_texts():
    rule = Rule("text", choices=("long", "short"))
    assert checked("long", rule, "f", "x") == "long"
    assert checked(np.array(["long", "short"], dtype=object), rule, "f", "x").tolist() == [
        "long",
        "short",
    ]
    for value in (
        "longer",
        1,
        None,
        ["long"],
        np.array(["long", "x"]),
        np.array([["long"]]),
        np.array([], dtype=str),
    ):
        with pytest.raises(InputError, match="long, short"):
            checked(value, rule, "f", "x")


def test_flags():
    assert checked(np.bool_(True), Rule("flag"), "f", "x") is True
    for value in (1, "true", None, []):
        with pytest.raises(InputError, match="true or false"):
            checked(value, Rule("flag"), "f", "x")


@pytest.mark.parametrize(
    ("field", "value"), [("kind", np.array(["long", "short"])), ("there", np.array([True, False]))]
)
def test_what_cannot_differ_within_a_batch_is_refused(field, value):
    with pytest.raises(InputError, match="cannot differ within a batch"):
        Part(length=1, **{field: value})
    assert Part(length=1, motor=np.array(["A", "B"])).motor.tolist() == ["A", "B"]


def test_from_mapping_keeps_origins():
    origins: dict[str, Origin] = {}
    data = {
        "mass": 3,
        "part": {"length": {"value": 1, "label": "paper", "source": "Table I"}, "com": [0, 0, 0.2]},
    }
    whole = parameters.from_mapping(Whole, data, "f", "", origins)
    assert whole.mass == 3.0
    assert whole.part.com.tolist() == [0, 0, 0.2]
    assert origins["part.length"] == Origin("paper", "Table I")
    assert origins["mass"] == Origin("user")
    assert origins["part.kind"].label == "assumed"
    assert set(origins) == set(parameters.leaves(whole)) == set(parameters.rules(Whole))


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (None, ["mapping"]),
        ([1], ["mapping"]),
        ({"mass": 1}, ["part", "missing"]),
        ({"mass": 1, "part": {}}, ["part.length", "missing", "[m]"]),
        ({"mass": 1, "part": 3}, ["part", "mapping"]),
        ({"mass": 1, "part": {"lenght": 1}}, ["part.lenght", "did you mean length"]),
        ({"mass": 1, "part": {"length": 1}, 5: 1}, ["5", "no such field"]),
        (
            {"mass": 1, "part": {"length": {"value": 1, "lable": "paper"}}},
            ["part.length.lable", "did you mean label?"],
        ),
        (
            {"mass": 1, "part": {"length": {"label": "paper"}}},
            ["part.length", "value, label, source"],
        ),
        (
            {"mass": 1, "part": {"length": {"value": 1, "label": "guess"}}},
            ["part.length.label", "guess", "paper"],
        ),
        ({"mass": 1, "part": {"length": {"value": 1, "label": []}}}, ["part.length.label"]),
    ],
)
def test_from_mapping_names_the_field(data, words):
    with pytest.raises(InputError) as caught:
        parameters.from_mapping(Whole, data, "file.yaml")
    for word in ["file.yaml", *words]:
        assert word in str(caught.value)


def test_with_values_replaces_by_path():
    whole = Whole(part=Part(length=1), mass=1)
    made = parameters.with_values(
        whole, {"part.length": 0.5, "mass": np.array([1.0, 2.0])}, "override"
    )
    assert (made.part.length, made.mass.tolist()) == (0.5, [1.0, 2.0])
    assert (whole.part.length, whole.mass) == (1.0, 1.0)
    with pytest.raises(dataclasses.FrozenInstanceError):
        made.mass = 3.0


@pytest.mark.parametrize(
    ("path", "word"),
    [
        ("part", "section"),
        ("part.lenght", "part.length"),
        ("mas", "mass"),
        ("", "no such"),
        ("mass.x", "no such"),
        (3, "no such"),
    ],
)
def test_with_values_names_a_path_that_is_no_leaf(path, word):
    with pytest.raises(InputError, match=word):
        parameters.with_values(Whole(part=Part(length=1), mass=1), {path: 1.0}, "override")


def test_a_pattern_matches_across_dots_and_a_path_is_itself():
    names = ["a.left.gear", "a.right.gear", "b.left.gear"]
    assert parameters.matching("a.*.gear", names) == names[:2]
    assert parameters.matching("*left*", names) == [names[0], names[2]]
    assert parameters.matching("a.left.gear", names) == ["a.left.gear"]
    assert parameters.matching("c.*", names) == ["c.*"]


def test_an_error_does_not_list_a_hundred_names():
    many = [f"a{i}.b{j}" for i in range(5) for j in range(20)]
    assert parameters.some(many) == "a0.*, a1.*, a2.*, a3.*, a4.*"
    assert parameters.some(many[:20]).endswith(", ...")
    assert parameters.some(["x", "y"]) == "x, y"


def test_an_empty_list_of_names_is_called_none():
    assert parameters.unknown("knee", [], "joint") == "no such joint; there are none"
