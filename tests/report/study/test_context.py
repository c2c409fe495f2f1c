from __future__ import annotations

import dataclasses

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.report.page import Missing, Picture
from hyperleg_design.report.study.context import Context
from hyperleg_design.robot.design import load_design


def refuse(path):
    raise InputError("figure", "size", 0, "expects more than nothing")


def test_pictures_lie_in_the_folder_of_the_page_and_one_that_fails_is_named(tmp_path):
    context = Context(load_design("hyperleg"), {}, tmp_path)
    (tmp_path / "figures").mkdir()
    drawn = context.picture("robot", "A robot.", lambda path: path.write_bytes(b"png"))
    assert isinstance(drawn, Picture)
    assert (tmp_path / drawn.file).read_bytes() == b"png"
    missing = context.picture("other", "Another robot.", refuse)
    assert isinstance(missing, Missing)
    assert "expects more than nothing" in missing.reason


def test_a_part_of_the_page_cannot_change_what_the_others_get(tmp_path):
    context = Context(load_design("hyperleg"), {}, tmp_path)
    with pytest.raises(dataclasses.FrozenInstanceError):
        context.folder = tmp_path / "elsewhere"
