"""The verbs view and video: what they show is what they were given."""

from __future__ import annotations

import json
import socket
from pathlib import Path

import pytest

from hyperleg_design import cli
from hyperleg_design.errors import HyperlegError
from hyperleg_design.gap.logs.log import write_log
from hyperleg_design.gap.logs.recording import log_of_trial
from hyperleg_design.report.pictures import video
from hyperleg_design.report.pictures.motion import walk_motion
from hyperleg_design.robot.load import load_robot
from tests.report.conftest import STRIDE_TIME, STRIDES, planned_walk

POLICY = "walk_upright-toe-0"


@pytest.fixture(scope="module")
def recording(tmp_path_factory) -> Path:
    """Log of a planned walk of the robot with a toe."""
    path = tmp_path_factory.mktemp("recorded") / "walk.parquet"
    write_log(path, log_of_trial(planned_walk(load_robot("toe")), metadata={"robot": "toe"}))
    return path


@pytest.fixture
def view(capsys):
    """Builds the page once on a free port; returns the exit code and what was printed."""
    pytest.importorskip("viser")

    def run(*arguments: str) -> tuple[int, str, str]:
        with socket.socket() as probe:
            probe.bind(("localhost", 0))
            port = probe.getsockname()[1]
        return cli.main(["view", *arguments, "--once", "--port", str(port)]), *capsys.readouterr()

    return run


def test_a_page_shows_the_designs_it_was_given(view):
    code, out, _ = view("teaching_leg", "--json")
    assert code == 0
    assert json.loads(out)["designs"] == ["teaching_leg"]
    code, out, _ = view("toe", "toe", "--set", "toe.mass=0.3", "--json")
    assert code == 0
    shown = json.loads(out)
    assert shown["designs"] == ["toe (1)", "toe (2)"]
    assert shown["walk"] is None


def test_a_page_of_a_recording_shows_the_robot_that_was_recorded(view, recording):
    code, out, _ = view("--recording", str(recording), "--json")
    assert code == 0
    shown = json.loads(out)
    assert shown["designs"] == ["toe"]
    assert "walk" in shown["walk"]
    assert view("--recording", str(recording))[1].startswith("open http://localhost:")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("toe", "--recording", "no.parquet"), "does not exist"),
        (("--recording", "a.parquet", "--policy", POLICY), "--recording"),
        (("--policy", "walk_upright-toe-99"), "walk_upright-toe-99"),
        (("toe", "--host", "nowhere.invalid"), "nowhere.invalid"),
        (("toe", "--set", "toe.mas=1"), "toe.mass"),
    ],
)
def test_what_cannot_be_shown_is_told(view, arguments, words):
    code, _, err = view(*arguments)
    assert code == 2
    assert words in err


SMALL = ("--fps", "10", "--size", "160", "128")


@pytest.fixture(scope="module")
def drawing():
    """Skips where this machine cannot draw."""
    try:
        video.drawn_frames(walk_motion(planned_walk(load_robot("toe")), duration=0.1), "probe")
    except HyperlegError as error:
        pytest.skip(str(error))


@pytest.mark.slow
def test_a_recording_becomes_a_video_of_the_time_asked_for(recording, tmp_path, capsys, drawing):
    from PIL import Image

    out = tmp_path / "walk.gif"
    command = ["video", str(recording), "--out", str(out), *SMALL, "--json"]
    assert cli.main([*command, "--duration", "0.5"]) == 0
    answer = json.loads(capsys.readouterr().out)
    image = Image.open(out)
    assert image.n_frames == answer["frames"]
    assert answer["frames"] in (5, 6)
    assert image.size == (160, 128)
    late = [*command, "--begin", str(10 * STRIDES * STRIDE_TIME), "--duration", "0.3"]
    assert cli.main(late) == 0
    assert json.loads(capsys.readouterr().out)["frames"] in (3, 4)


@pytest.mark.slow
def test_a_policys_walk_becomes_a_video_that_says_how_it_ended(tmp_path, capsys, drawing):
    out = tmp_path / "walk.gif"
    command = ["video", POLICY, "--duration", "0.3", "--out", str(out), *SMALL]
    assert cli.main(command) == 0
    printed = capsys.readouterr().out
    assert printed.startswith(f"{POLICY}/policy: ")
    assert " s\nwritten to " in printed
    assert out.read_bytes().startswith(b"GIF89a")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((POLICY, "--set", "toe.mass=1", "--out", "a.gif"), "needs --design"),
        ((POLICY, "--out", "a.webm"), ".mp4"),
        ((POLICY, "--size", "127", "96", "--out", "a.mp4"), "even"),
        (("none.parquet", "--out", "a.gif"), "none.parquet"),
        ((POLICY, "--duration", "0", "--out", "a.gif"), "--duration"),
    ],
)
def test_what_makes_no_video_is_told(arguments, words, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["video", *arguments]) == 2
    assert words in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
