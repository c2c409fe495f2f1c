from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import (
    HyperlegError,
    InfeasibleError,
    InputError,
    OutputError,
    in_short,
    meant,
    of_batch,
    shown,
)


def test_text_names_where_field_value_and_remedy():
    error = InputError("descriptions/a.yaml", "toe.mass", -1, "expects a number in kg")
    assert str(error) == "descriptions/a.yaml: toe.mass = -1: expects a number in kg"
    assert (error.where, error.field, error.value, error.remedy) == (
        "descriptions/a.yaml",
        "toe.mass",
        -1,
        "expects a number in kg",
    )


def test_the_error_of_a_batch_marks_the_designs_that_have_the_same():
    errors = {
        1: InputError("a", "toe", 1.0, "expects less"),
        2: InputError("b", "toe", 1.0, "expects more"),
        4: InputError("c", "toe", 3.0, "expects less"),
    }
    error = of_batch(errors, 5)
    assert str(error) == "a: toe = 1.0: expects less"
    np.testing.assert_array_equal(error.bad, [False, True, False, False, True])


def test_nothing_is_shown_of_a_value_that_is_not_there():
    assert (
        str(InputError("a.yaml", "toe.mass", None, "is missing [kg]"))
        == "a.yaml: toe.mass: is missing [kg]"
    )
    assert str(InputError("a.yaml", "", None, "cannot be read")) == "a.yaml: cannot be read"


@pytest.mark.parametrize("kind", [InputError, OutputError, InfeasibleError])
def test_one_base_for_all(kind):
    assert issubclass(kind, HyperlegError)


@given(
    st.recursive(
        st.none() | st.text() | st.integers() | st.binary() | st.floats(),
        lambda x: st.lists(x) | st.dictionaries(st.text(), x),
    )
)
@settings(max_examples=60)
def test_a_value_is_shown_in_one_short_line(value):
    assert len(shown(value)) <= 120
    assert "\n" not in shown(value)


def test_values_that_python_cannot_print():
    loop: list = []
    loop.append(loop)
    deep: list = []
    for _ in range(5000):
        deep = [deep]
    wide: dict = {}
    for _ in range(40):  # 2^40 leaves if printed
        wide = {"a": wide, "b": wide}
    for value in (loop, deep, wide, 10**5000):
        assert len(shown(value)) <= 120


def test_numpy_values_look_like_pythons():
    assert shown(np.float64(0.5)) == "0.5"
    assert shown(np.array([1.0, 2.0])) == "[1.0, 2.0]"


def test_a_field_with_odd_characters_stays_in_one_line():
    text = str(InputError("a.yaml", "x\ny" + "z" * 500, 1, "no such field"))
    assert "\n" not in text
    assert len(text) < 200


@pytest.mark.parametrize(
    ("said", "short"),
    [
        ("no such\n  file", "no such file"),
        ("this is not a parquet file", "this is not a ..."),
        ("x" * 30, "x" * 16 + " ..."),
    ],
)
def test_what_libraries_say_is_cut_between_words(said, short):
    assert in_short(ValueError(said), 20) == short


def test_a_name_that_does_not_exist_is_answered_by_the_nearest_or_by_all():
    assert meant("toe_mas", ["motors", "toe_mass"]) == "did you mean toe_mass?"
    assert meant("zzz", ["motors", "toe_mass"]) == "there are motors, toe_mass"
    assert meant("zzz", []) == "there are none"
    assert meant("ri70", ["RI60", "RI70", "ri7"]) == "did you mean RI70?"
    assert meant("TOEMASS", ["motors", "toe_mass"]) == "did you mean toe_mass?"
    assert meant("zzz", ["motors"], "ask") == "ask"
