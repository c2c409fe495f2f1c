"""Animations of motions as GIF files."""

from __future__ import annotations

import io
import os
from pathlib import Path

import numpy as np

from hyperleg_design.errors import HyperlegError
from hyperleg_design.report.pictures.motion import Motion, drawn_frames
from hyperleg_design.writing import write_bytes

MOST_BYTES = 2_000_000
"""Largest size of a GIF file [byte]."""


def render_gif(motion: Motion, path: str | os.PathLike[str]) -> Path:
    """Draw a motion into a GIF file of at most `MOST_BYTES`; colours, then frames are left out
    until it fits.

    Args:
        motion: what is drawn.
        path: of the file.

    Returns:
        The path.

    Raises:
        HyperlegError: this machine cannot draw, or no file small enough can be made.
        OutputError: the file cannot be written.
    """
    frames = drawn_frames(motion, path)
    for every, colours in ((1, 64), (1, 24), (2, 32), (2, 16), (3, 16), (4, 12)):
        content = gif_of(frames[::every], every * motion.frame_time, colours)
        if len(content) <= MOST_BYTES:
            return write_bytes(path, content)
    raise HyperlegError(
        f"{path}: the animation is too long for {MOST_BYTES / 1e6:g} MB; show less of it"
    )


def gif_of(frames: np.ndarray, frame_time: float, colours: int) -> bytes:
    """Make a GIF file that repeats frames.

    Args:
        frames: bytes, `(frames, height, width, 3)`.
        frame_time: for which each frame is shown [s].
        colours: in the palette.

    Returns:
        The content of the file.
    """
    from PIL import Image

    sample = frames[np.linspace(0, len(frames) - 1, 8).astype(int)]
    # one palette, so that nothing flickers
    first = Image.fromarray(sample.reshape(-1, *frames.shape[2:])).quantize(
        colours, dither=Image.Dither.NONE
    )
    images = [
        Image.fromarray(frame).quantize(palette=first, dither=Image.Dither.NONE) for frame in frames
    ]
    stream = io.BytesIO()
    images[0].save(
        stream,
        "GIF",
        save_all=True,
        append_images=images[1:],
        duration=round(1000 * frame_time),
        loop=0,
        optimize=False,
    )
    return stream.getvalue()
