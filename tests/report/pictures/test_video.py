"""Videos hold every frame, in the size and rate asked for."""

from __future__ import annotations

import io

import numpy as np
import pytest

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.report.pictures import motion, video


@pytest.fixture
def drawn(monkeypatch):
    """Frames of noise in place of drawn ones."""
    rng = np.random.default_rng(0)

    def frames(what, path):
        stream = io.BytesIO()
        np.save(stream, rng.integers(0, 255, (len(what.focus), 96, 128, 3)).astype(np.uint8))
        return stream.getvalue()

    monkeypatch.setattr(motion, "drawn", frames)


def shown(count, size=(128, 96)):
    return motion.Motion(
        (),
        np.empty((count, 0, 3, 3)),
        np.empty((count, 0, 3)),
        np.zeros((count, 3)),
        np.ones(3),
        size=size,
    )


def test_an_mp4_holds_every_frame(drawn, tmp_path):
    imageio = pytest.importorskip("imageio.v3")
    path = video.write_video(shown(60), tmp_path / "walk.mp4")
    properties = imageio.improps(path)
    assert properties.shape[1:] == (96, 128, 3)
    assert len(imageio.imread(path)) == 60
    assert imageio.immeta(path)["fps"] == pytest.approx(25.0)


def test_a_gif_holds_every_frame(drawn, tmp_path):
    from PIL import Image

    image = Image.open(video.write_video(shown(60), tmp_path / "walk.gif"))
    assert (image.n_frames, image.size, image.info["duration"]) == (60, (128, 96), 40)


@pytest.mark.parametrize(
    ("name", "size", "text"),
    [("a.webm", (128, 96), r"\.mp4 or \.gif"), ("a.mp4", (127, 96), "even"), ("a", (8, 8), "mp4")],
)
def test_what_cannot_be_written_is_refused(name, size, text, tmp_path):
    with pytest.raises(InputError, match=text):
        video.write_video(shown(2, size), tmp_path / name)


def test_a_place_that_is_closed_is_told_before_any_work(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written"):
        video.check_video(tmp_path / "file" / "a.gif", (128, 96))


def test_a_missing_encoder_is_told(monkeypatch, tmp_path):
    monkeypatch.setattr(video.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"hyperleg-design\[video\]"):
        video.write_video(shown(2), tmp_path / "a.mp4")
