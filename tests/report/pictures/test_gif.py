"""Animations become files that are small enough and not blank."""

from __future__ import annotations

import io

import numpy as np
import pytest

from hyperleg_design.errors import HyperlegError
from hyperleg_design.report.pictures import gif, motion


def test_frames_become_a_file_that_is_small_enough(monkeypatch, tmp_path):
    from PIL import Image

    rng = np.random.default_rng(0)
    frames = rng.integers(0, 255, (40, 60, 80, 3)).astype(np.uint8)
    content = gif.gif_of(frames, 0.05, 16)
    image = Image.open(io.BytesIO(content))
    assert (image.size, image.n_frames, image.info["duration"]) == ((80, 60), 40, 50)

    def saved(what, path):
        stream = io.BytesIO()
        np.save(stream, frames)
        return stream.getvalue()

    monkeypatch.setattr(motion, "drawn", saved)
    shown = motion.Motion((), np.empty(0), np.empty(0), np.zeros((40, 3)), np.ones(3))
    monkeypatch.setattr(gif, "MOST_BYTES", len(content) // 2)
    path = gif.render_gif(shown, tmp_path / "a.gif")
    assert path.stat().st_size <= len(content) // 2
    assert Image.open(path).n_frames < 40
    monkeypatch.setattr(gif, "MOST_BYTES", 100)
    with pytest.raises(HyperlegError, match="too long"):
        gif.render_gif(shown, tmp_path / "b.gif")
    assert not (tmp_path / "b.gif").exists()


def test_a_walk_is_drawn(walks, tmp_path):
    made = motion.walk_motion(walks["toe"], begin=2.0, duration=0.5, frames_per_second=10.0)
    try:
        path = gif.render_gif(made, tmp_path / "walk.gif")
    except HyperlegError as error:
        pytest.skip(str(error))
    from PIL import Image

    image = Image.open(path)
    assert image.n_frames == 5
    pixels = np.asarray(image.convert("RGB"))
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 10
