"""Draws one pickled `picture.Scene`: `python -m hyperleg_design.report.draw SCENE PNG`, started by `picture.render`."""

from __future__ import annotations

import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.report.picture import Scene, Solid


def _mesh(solid: Solid) -> Any:
    import pyvista as pv

    if solid.kind == "box":
        x, y, z = solid.size
        mesh = pv.Cube(x_length=x, y_length=y, z_length=z)
    elif solid.kind == "cylinder":
        mesh = pv.Cylinder(radius=solid.size[0], height=solid.size[1], direction=(0, 0, 1), resolution=48)
    elif solid.kind == "capsule":
        mesh = pv.Capsule(radius=solid.size[0], cylinder_length=solid.size[1], direction=(0, 0, 1), resolution=40)
    else:
        mesh = pv.Sphere(radius=solid.size[0], theta_resolution=36, phi_resolution=36)
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = solid.rotation, solid.position
    return mesh.transform(transform, inplace=False)


def draw(scene: Scene, path: Path) -> None:
    """Draw a scene into a PNG file."""
    import pyvista as pv

    plotter = pv.Plotter(off_screen=True, window_size=list(scene.size), lighting="three lights")
    plotter.set_background("white")
    for solid in scene.solids:
        smooth = solid.kind != "box"
        plotter.add_mesh(_mesh(solid), color=solid.colour, opacity=solid.opacity, smooth_shading=smooth, split_sharp_edges=smooth, specular=0.25)
    for start, end, colour, width in scene.lines:
        plotter.add_mesh(pv.Line(start, end), color=colour, line_width=width)
    for start, vector, colour in scene.arrows:
        length = float(np.linalg.norm(vector))
        arrow = pv.Arrow(start=start, direction=vector, scale=length, shaft_radius=0.035, tip_radius=0.09, tip_length=0.28)
        plotter.add_mesh(arrow, color=colour)
    for place, text, colour in scene.labels:
        plotter.add_point_labels(
            [place], [text], text_color=colour, font_size=scene.font, shape=None, show_points=False, always_visible=True,
            justification_horizontal="left", justification_vertical="center",
        )  # fmt: skip
    plotter.camera_position = [scene.camera[0], scene.camera[1], (0, 0, 1)]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = scene.height / 2
    plotter.enable_anti_aliasing("ssaa")
    plotter.screenshot(str(path))


if __name__ == "__main__":
    draw(pickle.loads(Path(sys.argv[1]).read_bytes()), Path(sys.argv[2]))
