import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.parameters.entries import (
    check_keys,
    checked_mapping,
    checked_number,
    checked_whole_number,
)


@pytest.mark.parametrize(("given", "value"), [(2, 2.0), ("1e-3", 1e-3), (-0.5, -0.5)])
def test_numbers_are_floats_also_from_text(given, value):
    found = checked_number(given, "file.yaml", "steps")
    assert found == value
    assert isinstance(found, float)


@pytest.mark.parametrize("given", [None, True, "2 m", float("nan"), float("inf"), [1.0], {}])
def test_what_is_no_finite_number_names_file_and_path(given):
    with pytest.raises(InputError, match=r"file\.yaml.*stages\.0\.steps.*expects a number"):
        checked_number(given, "file.yaml", "stages.0.steps")


@pytest.mark.parametrize("given", [0.99, 3.01])
def test_a_range_includes_its_ends_and_nothing_beyond(given):
    assert [checked_number(end, "file", "x", 1, 3) for end in (1, 3)] == [1.0, 3.0]
    with pytest.raises(InputError, match=r"within 1 \.\. 3"):
        checked_number(given, "file", "x", 1, 3)


def test_whole_numbers_may_be_written_as_floats_but_have_no_fraction():
    found = checked_whole_number("3e2", "file", "x", 1, 1000)
    assert found == 300
    assert isinstance(found, int)
    with pytest.raises(InputError, match=r"2\.5.*expects a whole number"):
        checked_whole_number(2.5, "file", "x")
    with pytest.raises(InputError, match="within"):
        checked_whole_number(0, "file", "x", 1, 1000)


@pytest.mark.parametrize("given", [None, [], "text", 1.0])
def test_a_mapping_stays_the_same_and_anything_else_is_refused(given):
    data = {"a": 1}
    assert checked_mapping(data, "file", "x") is data
    with pytest.raises(InputError, match=r"expects a mapping$"):
        checked_mapping(given, "file", "x")
    with pytest.raises(InputError, match="expects a mapping of names to sections"):
        checked_mapping(given, "file", "x", "of names to sections")


def test_keys_are_known_and_complete():
    check_keys({"name": 1, "steps": 2}, "file.yaml", "stage", ("name",), ("steps",))
    check_keys({}, "file.yaml", "", ())
    with pytest.raises(InputError, match=r"file\.yaml.*stage\.step.*did you mean steps"):
        check_keys({"name": 1, "step": 2}, "file.yaml", "stage", ("name",), ("steps",))
    with pytest.raises(InputError, match=r"file\.yaml: name.*is missing"):
        check_keys({"steps": 2}, "file.yaml", "", ("name",), ("steps",))
