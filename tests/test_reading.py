from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.reading import (
    MAX_DEPTH,
    given_path,
    parse_yaml,
    read_yaml,
    short_name,
    summary_line,
)


def test_a_mapping_is_read(write):
    assert read_yaml(write("a.yaml", "a: {b: [1, 2.5, x]}\n")) == {"a": {"b": [1, 2.5, "x"]}}


@pytest.mark.parametrize(
    ("text", "line", "word"),
    [
        ("a: 1\nb: [1, 2\n", None, "not YAML"),
        ("a: 1\n\tb: 2\n", 2, "not YAML"),
        ("a: 1\nb: 2\na: 3\n", 3, "a stands twice"),
        ("a:\n  b: 1\n  b: 2\n", 3, "b stands twice"),
        ("a: 1\n? [b]\n: 2\n", 2, "plain word"),
        ("a: 1\nb: !!python/object:os.system x\n", 2, "not YAML"),
        ("a: 2020-13-45\n", 1, "month"),
        ("a: 1\nb: !!int x\n", 2, "no value"),
        ("a: 1\nb: 1:6\n", 2, "'1:6' is no number"),  # YAML's own rules make it 66
        ("a: [1, 2:30.5]\n", 1, "'2:30.5' is no number"),
        ("a: &x [1]\nb: *y\n", 2, "alias"),
        ("a: " + "1" * 5000, 1, "digits"),
        ("[" * 100_000, 1, str(MAX_DEPTH)),
        ("- " * 100_000, 1, str(MAX_DEPTH)),
        ("- 1\n- 2\n", None, "mapping"),
        ("", None, "mapping"),
        ("just words", None, "mapping"),
        (b"a: \xff\xfe\xfa", None, "UTF-8"),
        ("a: \0", None, "not YAML"),
    ],
)
def test_what_is_wrong_is_said_with_file_and_line(write, text, line, word):
    path = write("broken.yaml", text)
    with pytest.raises(InputError) as caught:
        read_yaml(path)
    message = str(caught.value)
    assert "broken.yaml" in message
    assert word in message
    assert line is None or f"line {line}" in message
    assert "\n" not in message


def test_files_that_cannot_be_opened(tmp_path: Path):
    for path in (tmp_path / "missing.yaml", tmp_path):
        with pytest.raises(InputError, match="cannot be read"):
            read_yaml(path)


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
        lambda x: st.lists(x, max_size=3),
        max_leaves=5,
    )
)
@settings(max_examples=50)
def test_strictness_changes_no_value(value):
    text = yaml.safe_dump({"key": value})
    assert parse_yaml(text) == yaml.safe_load(text)


@given(st.binary(max_size=60))
@settings(max_examples=200)
def test_any_bytes_are_read_or_refused(tmp_path_factory, content):
    path = tmp_path_factory.getbasetemp() / "bytes.yaml"
    path.write_bytes(content)
    try:
        assert isinstance(read_yaml(path), dict)
    except InputError:
        return


def test_messages_name_a_file_as_it_was_given():
    for path in (
        "results/bad/a.yaml",
        "/work/results/bad/a.yaml",
        "a.yaml",
        "../descriptions/a.yaml",
    ):
        assert given_path(Path(path)) == path
        with pytest.raises(InputError, match=f"^{path}: cannot be read"):
            read_yaml(Path(path))
    assert given_path(resources.find("descriptions", "hyperleg")) == "descriptions/hyperleg.yaml"
    assert given_path(Path("descriptions/hyperleg.yaml")) == "descriptions/hyperleg.yaml"


def test_short_name():
    assert short_name(Path("/a/b/c.yaml")) == "b/c.yaml"
    assert short_name(Path("c.yaml")) == "c.yaml"
    assert short_name(Path(".")) == "."


def test_a_summary_line_joins_what_the_source_wraps_and_leaves_out_what_follows():
    def documented():
        """One sentence that
        is wrapped.

        Another paragraph.
        """

    def silent(): ...

    assert summary_line(documented) == "One sentence that is wrapped."
    assert summary_line(silent) == ""
