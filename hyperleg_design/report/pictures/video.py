"""Videos of walks as MP4 or GIF files."""

from __future__ import annotations

import importlib.util
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.report.pictures.gif import gif_of
from hyperleg_design.report.pictures.motion import Motion, drawn_frames
from hyperleg_design.writing import check_output_file, write_bytes

KINDS = (".mp4", ".gif")
"""Endings of the files that can be written."""
LARGEST = 4096
"""Largest width or height of a frame [px], at which the frames drawn together take 1.3 GB."""
_PART = 25
"""Frames drawn together, between two steps of the progress bar."""
_GIF_COLOURS = 64


def check_video(path: Path, size: tuple[int, int]) -> None:
    """Check that a video can be written, before anything is simulated.

    Args:
        path: of the file.
        size: of a frame [px].

    Raises:
        InputError: another ending than `KINDS`, an odd or very small size, or a package is missing.
        OutputError: nothing can be written there.
    """
    if path.suffix.lower() not in KINDS:
        ending = " or ".join(KINDS)
        raise InputError("video", "--out", str(path), f"expects a file that ends in {ending}")
    if min(size) < 64 or max(size) > LARGEST or any(length % 2 for length in size):
        remedy = f"expects even numbers within 64 .. {LARGEST}"
        raise InputError("video", "--size", list(size), remedy)
    if path.suffix.lower() == ".mp4" and importlib.util.find_spec("imageio_ffmpeg") is None:
        raise InputError(
            "video",
            "--out",
            str(path),
            "needs imageio with ffmpeg: pip install 'hyperleg-design[video]', or name a .gif file",
        )
    check_output_file(path)


def write_video(motion: Motion, path: str | Path, *, progress: bool = False) -> Path:
    """Draw a motion into a file, which is written whole or not at all.

    Args:
        motion: what to draw.
        path: ends in .mp4 or .gif.
        progress: show a bar.

    Returns:
        The path.

    Raises:
        InputError: as `check_video`.
        HyperlegError: this machine cannot draw.
        OutputError: the file cannot be written.
    """
    path = Path(path)
    check_video(path, motion.size)
    parts = _drawn(motion, path, progress)
    if path.suffix.lower() == ".gif":
        return write_bytes(
            path, gif_of(np.concatenate(list(parts)), motion.frame_time, _GIF_COLOURS)
        )
    return write_bytes(path, _mp4(parts, 1 / motion.frame_time))


def _drawn(motion: Motion, path: Path, progress: bool) -> Iterator[np.ndarray]:
    """Frames in parts, `(up to _PART, height, width, 3)`."""
    from tqdm import tqdm

    count = len(motion.focus)
    with tqdm(total=count, disable=not progress, desc="video", unit="frame") as bar:
        for begin in range(0, count, _PART):
            rows = slice(begin, begin + _PART)
            part = replace(
                motion,
                rotations=motion.rotations[rows],
                positions=motion.positions[rows],
                focus=motion.focus[rows],
            )
            yield drawn_frames(part, path)
            bar.update(len(part.focus))


def _mp4(parts: Iterator[np.ndarray], rate: float) -> bytes:
    import imageio.v2 as imageio

    with tempfile.TemporaryDirectory(prefix="hyperleg-") as folder:
        target = Path(folder) / "video.mp4"
        writer: Any
        with imageio.get_writer(target, fps=rate, quality=8, macro_block_size=2) as writer:
            for part in parts:
                for frame in part:
                    writer.append_data(frame)
        return target.read_bytes()
