"""What verbs print for programs, and what an extra that is missing says."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import pytest

from hyperleg_design.cli.output import emit, require
from hyperleg_design.errors import InputError


@dataclass(frozen=True)
class Answer:
    folder: Path
    values: tuple[float, ...]


def test_dataclasses_and_paths_become_plain_json(capsys):
    emit({"answer": Answer(Path("a/b"), (1.0, 2.5))})
    printed = json.loads(capsys.readouterr().out)
    assert printed == {"answer": {"folder": "a/b", "values": [1.0, 2.5]}}


def test_numbers_that_json_lacks_are_refused():
    with pytest.raises(ValueError, match="JSON"):
        emit({"value": float("nan")})
    with pytest.raises(TypeError, match="set"):
        emit({"value": {1}})


def test_a_missing_package_names_the_extra():
    require("json")
    with pytest.raises(InputError, match=r"needs no_such_package: .*hyperleg-design\[learning\]"):
        require("json", "no_such_package")
