from __future__ import annotations

import errno
import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from hyperleg_design import writing
from hyperleg_design.errors import OutputError


def everything(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def full_disk(*_args, **_kwargs):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_files_are_written_with_their_folders(tmp_path: Path):
    assert writing.write_text(tmp_path / "a" / "b.txt", "é").read_bytes() == "é".encode()
    writing.write_json(tmp_path / "c.json", {"x": [1, 0.1]})
    assert json.loads((tmp_path / "c.json").read_text()) == {"x": [1, 0.1]}
    assert sorted(everything(tmp_path)) == ["a/b.txt", "c.json"]


@pytest.mark.parametrize("place", ["fsync", "rename"])
def test_a_full_disk_leaves_the_old_file(tmp_path: Path, monkeypatch, place):
    path = writing.write_text(tmp_path / "a.txt", "old")
    if place == "fsync":
        monkeypatch.setattr(os, "fsync", full_disk)
    else:
        monkeypatch.setattr(Path, "replace", full_disk)
    with pytest.raises(
        OutputError, match=r"a\.txt: cannot be written \(No space left on device\); free some space"
    ):
        writing.write_text(path, "new")
    assert everything(tmp_path) == {"a.txt": b"old"}


def test_an_interrupt_leaves_nothing_behind(tmp_path: Path, monkeypatch):
    def interrupted(_handle):
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupted)
    with pytest.raises(KeyboardInterrupt):
        writing.write_text(tmp_path / "a.txt", "new")
    assert everything(tmp_path) == {}


def test_numbers_that_json_cannot_say(tmp_path: Path):
    with pytest.raises(OutputError, match="finite"):
        writing.write_json(tmp_path / "a.json", {"x": float("nan")})
    assert everything(tmp_path) == {}


def test_a_place_that_is_no_folder(tmp_path: Path):
    (tmp_path / "file").touch()
    for action in (
        lambda: writing.write_text(tmp_path / "file" / "a.txt", "x"),
        lambda: writing.check_output_folder(tmp_path / "file"),
    ):
        with pytest.raises(OutputError, match="file"):
            action()


def test_a_folder_in_place_of_a_file_is_told(tmp_path: Path):
    (tmp_path / "a").mkdir()
    with pytest.raises(OutputError, match="a: is a folder; give the name of a file"):
        writing.write_text(tmp_path / "a", "x")
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def make(folder: Path, text: str) -> None:
    with writing.output_folder(folder) as inside:
        (inside / "a.txt").write_text(text)


def test_our_folder_is_replaced_as_a_whole(tmp_path: Path):
    out = tmp_path / "deep" / "out"
    make(out, "one")
    with writing.output_folder(out) as inside:
        (inside / "b.txt").touch()
    make(out, "two")
    assert everything(tmp_path / "deep") == {
        "out/a.txt": b"two",
        f"out/{writing.MARKER}": (out / writing.MARKER).read_bytes(),
    }


def test_somebody_elses_folder_is_refused(tmp_path: Path):
    (tmp_path / "thesis.tex").write_text("mine")
    with pytest.raises(OutputError, match="did not write"):
        make(tmp_path, "x")
    assert everything(tmp_path) == {"thesis.tex": b"mine"}


def test_an_empty_folder_and_a_relative_one_are_taken(tmp_path: Path, monkeypatch):
    (tmp_path / "out").mkdir()
    make(tmp_path / "out", "x")
    monkeypatch.chdir(tmp_path)
    make(Path("other"), "y")
    assert (tmp_path / "other" / "a.txt").read_text() == "y"


@pytest.mark.parametrize("failure", [ValueError, KeyboardInterrupt])
def test_a_failure_inside_changes_nothing(tmp_path: Path, failure):
    make(tmp_path / "out", "old")
    before = everything(tmp_path)

    def fail():
        with writing.output_folder(tmp_path / "out") as inside:
            (inside / "a.txt").write_text("new")
            raise failure

    with pytest.raises(failure):
        fail()
    assert everything(tmp_path) == before


def test_the_old_folder_comes_back_if_the_new_one_cannot_take_its_place(
    tmp_path: Path, monkeypatch
):
    make(tmp_path / "out", "old")
    before = everything(tmp_path)
    replace, calls = Path.replace, []

    def second_fails(self: Path, target: Path) -> Path:
        calls.append(target)
        return full_disk() if len(calls) == 2 else replace(self, target)

    monkeypatch.setattr(Path, "replace", second_fails)
    with pytest.raises(OutputError, match="out: cannot be written"):
        make(tmp_path / "out", "new")
    assert everything(tmp_path) == before


def test_an_error_names_the_file_where_it_would_have_stood(tmp_path: Path, monkeypatch):
    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(OutputError) as caught, writing.output_folder(tmp_path / "out") as inside:
        writing.write_text(inside / "robot.urdf", "x")
    assert str(tmp_path / "out" / "robot.urdf") in str(caught.value)
    assert everything(tmp_path) == {}


@pytest.fixture
def small_disk(tmp_path: Path):
    """A file system of 64 kB."""
    place = tmp_path / "disk"
    place.mkdir()
    if (
        shutil.which("mount") is None
        or subprocess.run(
            ["mount", "-t", "tmpfs", "-o", "size=64k", "none", str(place)], capture_output=True
        ).returncode
    ):
        pytest.skip("no file system can be mounted here")
    yield place
    subprocess.run(["umount", str(place)], check=True)


def test_a_disk_that_is_really_full(small_disk: Path):
    path = writing.write_text(small_disk / "a.txt", "old")
    with pytest.raises(OutputError, match="No space left"):
        writing.write_bytes(path, bytes(200_000))
    with (
        pytest.raises(OutputError, match="No space left"),
        writing.output_folder(small_disk / "out") as inside,
    ):
        writing.write_bytes(inside / "big", bytes(200_000))
    assert everything(small_disk) == {"a.txt": b"old"}


def test_what_somebody_added_to_a_folder_stays(tmp_path):
    out = tmp_path / "out"
    for text in ("one", "two"):
        with writing.output_folder(out) as inside:
            (inside / "sub").mkdir()
            (inside / "sub" / "ours.txt").write_text(text)
            (inside / f"{text}.csv").write_text(text)
        (out / "sub" / "mine.txt").write_text("mine")
    assert {p.name: p.read_text() for p in out.rglob("*.*") if p.name != writing.MARKER} == {
        "ours.txt": "two",
        "two.csv": "two",
        "mine.txt": "mine",
    }
    with writing.output_folder(out, keep=("*.csv",)) as inside:
        (inside / "three.csv").write_text("three")
    assert {p.name for p in out.rglob("*.*")} == {
        writing.MARKER,
        "two.csv",
        "three.csv",
        "mine.txt",
    }


def test_plain_values_survive_json_and_what_is_no_number_becomes_none():
    row = {"a": np.float64(0.5), "b": np.int64(3), "c": np.nan, "d": np.float32(np.inf), "e": "x"}
    found = writing.plain({**row, 7: np.bool_(True), "f": (1.5, [np.nan])})
    assert found == {
        "a": 0.5,
        "b": 3,
        "c": None,
        "d": None,
        "e": "x",
        "7": True,
        "f": [1.5, [None]],
    }
    assert json.loads(json.dumps(found, allow_nan=False)) == found


def test_a_place_below_a_file_or_closed_to_writing_is_told_before_any_work(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(OutputError, match=r"file: is a file"):
        writing.check_output_folder(tmp_path / "file" / "out")
    with pytest.raises(OutputError, match="choose another --logs"):
        writing.check_output_folder(tmp_path / "file", "--logs")
    writing.check_output_file(tmp_path / "new" / "a.gif")
    for place in ("file/a.gif", "."):
        with pytest.raises(OutputError, match=r"cannot be written|is a folder"):
            writing.check_output_file(tmp_path / place)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
    monkeypatch.setattr(writing.os, "access", lambda place, mode: False)
    with pytest.raises(OutputError, match="closed to writing"):
        writing.check_output_folder(tmp_path / "out")
