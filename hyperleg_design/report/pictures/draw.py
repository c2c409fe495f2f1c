"""Draws one pickled `picture.Scene` or `motion.Motion`: `python -m
hyperleg_design.report.pictures.draw SOURCE TARGET`, started by `picture.drawn`.
"""

from __future__ import annotations

import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.report.pictures.motion import Motion
from hyperleg_design.report.pictures.picture import Scene, Solid


def _mesh(solid: Solid, fine: bool = True) -> Any:
    import pyvista as pv

    if solid.kind == "box":
        x, y, z = solid.size
        return pv.Cube(x_length=x, y_length=y, z_length=z)
    if solid.kind == "cylinder":
        return pv.Cylinder(
            radius=solid.size[0],
            height=solid.size[1],
            direction=(0, 0, 1),
            resolution=48 if fine else 24,
        )
    if solid.kind == "capsule":
        return pv.Capsule(
            radius=solid.size[0],
            cylinder_length=solid.size[1],
            direction=(0, 0, 1),
            resolution=40 if fine else 16,
        )
    return pv.Sphere(
        radius=solid.size[0], theta_resolution=36 if fine else 14, phi_resolution=36 if fine else 14
    )


def _transform(rotation: np.ndarray, position: np.ndarray) -> np.ndarray:
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = rotation, position
    return transform


def _add(plotter: Any, solid: Solid, mesh: Any, lighting: bool = True) -> Any:
    smooth = solid.kind != "box"
    look = (
        {"smooth_shading": smooth, "split_sharp_edges": smooth, "specular": 0.25}
        if lighting
        else {"lighting": False}
    )
    return plotter.add_mesh(mesh, color=solid.colour, opacity=solid.opacity, **look)


def draw(scene: Scene, path: Path) -> None:
    """Draw a scene into a PNG file.

    Args:
        scene: what is drawn.
        path: of the file.
    """
    import pyvista as pv

    plotter = pv.Plotter(off_screen=True, window_size=list(scene.size), lighting="three lights")
    plotter.set_background("white")
    for solid in scene.solids:
        _add(
            plotter,
            solid,
            _mesh(solid).transform(_transform(solid.rotation, solid.position), inplace=False),
        )
    for start, end, colour, width in scene.lines:
        plotter.add_mesh(pv.Line(start, end), color=colour, line_width=width)
    for start, vector, colour in scene.arrows:
        length = float(np.linalg.norm(vector))
        arrow = pv.Arrow(
            start=start,
            direction=vector,
            scale=length,
            shaft_radius=0.035,
            tip_radius=0.09,
            tip_length=0.28,
        )
        plotter.add_mesh(arrow, color=colour)
    _labels(plotter, scene.labels, scene.font)
    plotter.camera_position = [scene.camera[0], scene.camera[1], (0, 0, 1)]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = scene.height / 2
    plotter.enable_anti_aliasing("ssaa")
    plotter.screenshot(str(path.with_suffix(".png")), transparent_background=True)
    path.with_suffix(".png").replace(path)


def draw_motion(motion: Motion, path: Path) -> None:
    """Draw all frames of a motion into an `.npy` file, `(frames, height, width, 3)` of bytes.

    Args:
        motion: what is drawn.
        path: of the file.
    """
    import pyvista as pv

    plotter = pv.Plotter(off_screen=True, window_size=list(motion.size), lighting="three lights")
    plotter.set_background("white")
    for start, end, colour, width in motion.lines:
        plotter.add_mesh(pv.Line(start, end), color=colour, line_width=width)
    for solid in motion.still:
        mesh = _mesh(solid, fine=False).transform(
            _transform(solid.rotation, solid.position), inplace=False
        )
        _add(plotter, solid, mesh, lighting=solid.kind != "box")  # the floor has no shades
    actors = [_add(plotter, solid, _mesh(solid, fine=False)) for solid in motion.solids]
    _labels(plotter, motion.labels, motion.font)
    plotter.camera_position = [motion.focus[0] + motion.eye, motion.focus[0], (0, 0, 1)]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = motion.height / 2
    plotter.enable_anti_aliasing("fxaa")
    frames = np.empty((len(motion.focus), motion.size[1], motion.size[0], 3), np.uint8)
    for i, focus in enumerate(motion.focus):
        for actor, rotation, position in zip(
            actors, motion.rotations[i], motion.positions[i], strict=True
        ):
            actor.user_matrix = _transform(rotation, position)
        plotter.camera.position, plotter.camera.focal_point = focus + motion.eye, focus
        plotter.reset_camera_clipping_range()
        plotter.render()
        frames[i] = plotter.screenshot(return_img=True)
    with path.open("wb") as stream:
        np.save(stream, frames)


def _labels(plotter: Any, labels: Any, font: int) -> None:
    for place, text, colour in labels:
        plotter.add_point_labels(
            [place],
            [text],
            text_color=colour,
            font_size=font,
            shape=None,
            show_points=False,
            always_visible=True,
            justification_horizontal="left",
            justification_vertical="center",
        )


if __name__ == "__main__":
    content = pickle.loads(Path(sys.argv[1]).read_bytes())
    (draw_motion if isinstance(content, Motion) else draw)(content, Path(sys.argv[2]))
