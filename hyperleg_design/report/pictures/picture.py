"""The robot in three dimensions, drawn by pyvista without a screen.

Drawing happens in a process of its own: graphics libraries end the whole process where they fail,
and a report should not die of a missing picture.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import HyperlegError
from hyperleg_design.writing import write_bytes

TIMEOUT = 180.0
"""Longest that one picture may take [s]."""


@dataclass(frozen=True)
class Solid:
    """A coloured primitive in the world."""

    kind: str
    """`box`, `cylinder` (z), `sphere` or `capsule` (z)."""
    size: tuple[float, ...]
    """Full sizes, radius and length, or radius [m]."""
    rotation: np.ndarray
    position: np.ndarray
    colour: str
    opacity: float = 1.0

    @property
    def reach(self) -> np.ndarray:
        """How far it reaches from its position along the axes of the world [m], `(3,)`."""
        if self.kind == "sphere":
            return np.full(3, self.size[0])
        half = np.array(self.size) / 2
        if self.kind != "box":
            radius, length = self.size
            half = np.array([radius, radius, length / 2 + radius * (self.kind == "capsule")])
        return np.asarray(np.abs(self.rotation) @ half)


@dataclass(frozen=True)
class Scene:
    """The bodies, lines, labels and camera of one picture."""

    solids: tuple[Solid, ...] = ()
    lines: tuple[tuple[np.ndarray, np.ndarray, str, float], ...] = ()
    """Lines: start and end [m], colour, width [px]."""
    labels: tuple[tuple[np.ndarray, str, str], ...] = ()
    """Place [m], text, colour."""
    arrows: tuple[tuple[np.ndarray, np.ndarray, str], ...] = ()
    """Arrows: start [m], vector [m], colour."""
    camera: tuple[tuple[float, float, float], tuple[float, float, float]] = (
        (2.0, -2.0, 0.9),
        (0.0, 0.0, 0.45),
    )
    """Eye and focus [m]."""
    height: float = 1.1
    """What the picture's height spans [m]."""
    size: tuple[int, int] = (900, 1000)
    """Width and height of the picture [px]."""
    font: int = 20


def render(scene: Scene, path: str | os.PathLike[str]) -> Path:
    """Draw a scene into a PNG file.

    Args:
        scene: what is drawn.
        path: of the file.

    Returns:
        The path.

    Raises:
        HyperlegError: this machine cannot draw (no OpenGL), or drawing fails.
    """
    return write_bytes(path, drawn(scene, path))


def drawn(what: Any, path: str | os.PathLike[str]) -> bytes:
    """Draw a scene or a motion with `report.pictures.draw`, in a process of its own.

    Args:
        what: anything that `report.pictures.draw` knows.
        path: for messages.

    Returns:
        A PNG file, or an `.npy` file of frames.

    Raises:
        HyperlegError: this machine cannot draw (no OpenGL), or drawing fails.
    """
    environment = dict(os.environ)
    if not environment.get("DISPLAY") and sys.platform.startswith("linux"):
        environment.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    with tempfile.TemporaryDirectory(prefix="hyperleg-") as folder:
        source, target = Path(folder) / "scene.pickle", Path(folder) / "picture"
        source.write_bytes(pickle.dumps(what))
        command = [
            sys.executable,
            "-m",
            "hyperleg_design.report.pictures.draw",
            str(source),
            str(target),
        ]
        try:
            done = subprocess.run(
                command,
                capture_output=True,
                text=True,
                timeout=TIMEOUT,
                env=environment,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise HyperlegError(f"{path}: drawing took longer than {TIMEOUT:g} s") from None
        if done.returncode or not target.exists():
            last = (done.stderr.strip().splitlines() or ["no message"])[-1]
            raise HyperlegError(
                f"{path}: cannot draw in 3-D on this machine ({last}); install an OpenGL library "
                f"such as libegl1"
            )
        return target.read_bytes()
