"""Drawing without a screen: what is put before the camera is where it belongs in the picture."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.errors import HyperlegError
from hyperleg_design.report.pictures import draw
from hyperleg_design.report.pictures.motion import Motion, drawn_frames
from hyperleg_design.report.pictures.picture import Solid

RED = "#d00000"
BALL = Solid("sphere", (0.1,), np.eye(3), np.zeros(3), RED)


def red(pixels):
    """Rows and columns of red pixels, as shares of the picture."""
    pixels = np.asarray(pixels, int)
    is_red = (pixels[..., 0] > 80) & (pixels[..., 0] > 2 * pixels[..., 1])
    rows, columns = np.nonzero(is_red)
    return rows / pixels.shape[0], columns / pixels.shape[1], is_red.mean()


@pytest.fixture(scope="module")
def frames(tmp_path_factory):
    """A ball in the middle, then to the right, then up, seen along +y; 1 m is the whole height."""
    places = np.array([[0.0, 0.0, 0.0], [0.25, 0.0, 0.0], [0.0, 0.0, 0.25]])
    motion = Motion(
        solids=(BALL,),
        rotations=np.tile(np.eye(3), (3, 1, 1, 1)),
        positions=places[:, None],
        focus=np.zeros((3, 3)),
        eye=np.array([0.0, -3.0, 0.0]),
        height=1.0,
        size=(120, 120),
    )
    try:
        return drawn_frames(motion, tmp_path_factory.mktemp("frames") / "a.gif")
    except HyperlegError as error:
        pytest.skip(f"no OpenGL here: {error}")


def test_frames_show_the_solid_where_it_is(frames):
    assert frames.shape == (3, 120, 120, 3)
    for frame, (row, column) in zip(frames, [(0.5, 0.5), (0.5, 0.75), (0.25, 0.5)], strict=True):
        rows, columns, share = red(frame)
        assert (rows.mean(), columns.mean()) == (
            pytest.approx(row, abs=0.03),
            pytest.approx(column, abs=0.03),
        )
        # a disc of 0.1 m in 1 m x 1 m; its dark rim is not counted as red
        assert 0.6 * np.pi * 0.01 < share < 1.1 * np.pi * 0.01


@pytest.mark.parametrize(
    ("kind", "size", "extent"),
    [
        ("box", (0.2, 0.4, 0.6), (0.2, 0.4, 0.6)),
        ("cylinder", (0.1, 0.6), (0.2, 0.2, 0.6)),
        ("capsule", (0.1, 0.6), (0.2, 0.2, 0.8)),
        ("sphere", (0.1,), (0.2, 0.2, 0.2)),
    ],
)
@pytest.mark.parametrize("fine", [True, False])
def test_every_kind_of_solid_has_its_size_about_its_middle(kind, size, extent, fine):
    solid = dataclasses.replace(BALL, kind=kind, size=size)
    low, high = np.reshape(draw._mesh(solid, fine).bounds, (3, 2)).T
    np.testing.assert_allclose(high - low, extent, rtol=0.05)
    np.testing.assert_allclose(high + low, 0.0, atol=0.01)
