"""Replays of a policy: as a GIF file, or in the browser by viser where that is installed."""

from __future__ import annotations

import importlib.util
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.evaluate import evaluate, protocol_for
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.protocol import Protocol, TTestProtocol, load_protocol
from hyperleg_design.report.pictures.motion import Motion, render_gif, t_test_motion, walk_motion
from hyperleg_design.report.pictures.picture import Solid

if TYPE_CHECKING:
    from hyperleg_design.evaluation.policy import Policy
    from hyperleg_design.evaluation.result import Evaluation
    from hyperleg_design.robot.design import Design
    from hyperleg_design.simulation.tasks import Task

BROWSER_RATE = 20.0
"""Frames a second in the browser."""


def replay(
    policy: Policy | str | Path,
    protocol: Protocol | str | Path | None = None,
    *,
    seed: int | None = None,
    design: Design | None = None,
    task: Task | None = None,
) -> Evaluation:
    """One trial of a policy with all its signals.

    Args:
        policy: as in `evaluate`.
        protocol: as in `evaluate`; only its first trial is run.
        seed: of the starting state; the protocol's by default.
        design: as in `evaluate`.
        task: as in `evaluate`.

    Raises:
        InputError: as `evaluate`.
    """
    chosen = load_policy(policy) if isinstance(policy, str | Path) else policy
    run = (
        protocol_for(chosen, task)
        if protocol is None
        else load_protocol(protocol)
        if isinstance(protocol, str | Path)
        else protocol
    )
    one = run.changed(trials=1) if seed is None else run.changed(trials=1, seed=seed)
    return evaluate(chosen, one, design=design, task=task, threads=1)


def motion_of(found: Evaluation, **options: Any) -> Motion:
    """The animation of a replay: a walk from aside, a T-test from above.

    Args:
        found: of `replay`.
        options: of `motion.walk_motion` or `motion.t_test_motion`.
    """
    trial = found.trials[0]
    if isinstance(found.protocol, TTestProtocol):
        return t_test_motion(trial, found.protocol, **options)
    return walk_motion(trial, **options)


def replay_gif(found: Evaluation, path: str | Path) -> Path:
    """Write a replay as a GIF file.

    Raises:
        HyperlegError: this machine cannot draw.
        OutputError: the file cannot be written.
    """
    return render_gif(motion_of(found), path)


def check_browser() -> None:
    """Check that viser, which shows a replay in the browser, is installed.

    Raises:
        InputError: it is not.
    """
    if importlib.util.find_spec("viser") is None:
        raise InputError(
            "replay",
            "viser",
            None,
            "is not installed: pip install viser, or write a file with --gif FILE",
        )


def replay_in_browser(found: Evaluation, *, port: int = 8080, rounds: int | None = None) -> str:
    """Show a replay in the browser, again and again.

    Args:
        found: of `replay`.
        port: of the server, on this machine.
        rounds: how often; until it is stopped by default.

    Returns:
        Address of the server, which ends when this returns.

    Raises:
        InputError: viser is not installed.
    """
    check_browser()
    import viser

    trial = found.trials[0]
    duration = trial.samples * trial.time_step
    if isinstance(found.protocol, TTestProtocol):
        motion = t_test_motion(
            trial, found.protocol, frames_per_second=BROWSER_RATE, most_frames=10_000
        )
    else:
        motion = walk_motion(trial, begin=0.0, duration=duration, frames_per_second=BROWSER_RATE)
    server = viser.ViserServer(port=port)
    try:
        server.scene.set_up_direction("+z")
        for i, solid in enumerate(motion.still):
            _put(server, f"/still/{i}", solid, solid.rotation, solid.position)
        for i, (start, end, colour, width) in enumerate(motion.lines):
            server.scene.add_line_segments(
                f"/lines/{i}",
                np.array([[start, end]]),
                colors=np.array(_rgb(colour)),
                line_width=width,
            )
        handles = [
            _put(server, f"/robot/{i}", solid, rotation, place)
            for i, (solid, rotation, place) in enumerate(
                zip(motion.solids, motion.rotations[0], motion.positions[0], strict=True)
            )
        ]
        done = 0
        while rounds is None or done < rounds:
            for rotations, positions in zip(motion.rotations, motion.positions, strict=True):
                with server.atomic():
                    for handle, rotation, place in zip(handles, rotations, positions, strict=True):
                        handle.wxyz, handle.position = _quaternion(rotation), place
                time.sleep(1 / BROWSER_RATE)
            done += 1
    finally:
        server.stop()
    return f"http://localhost:{port}"


def _put(server: Any, name: str, solid: Solid, rotation: np.ndarray, place: np.ndarray) -> Any:
    """Add a solid to the scene."""
    import trimesh

    if solid.kind == "box":
        mesh = trimesh.creation.box(extents=solid.size)
    elif solid.kind == "cylinder":
        mesh = trimesh.creation.cylinder(radius=solid.size[0], height=solid.size[1])
    elif solid.kind == "capsule":
        mesh = trimesh.creation.capsule(radius=solid.size[0], height=solid.size[1])
        mesh.apply_translation(
            [0.0, 0.0, -float(mesh.bounds.mean(0)[2])]
        )  # trimesh's begins at its lower end in some versions
    else:
        mesh = trimesh.creation.icosphere(radius=solid.size[0], subdivisions=2)
    return server.scene.add_mesh_simple(
        name,
        mesh.vertices,
        mesh.faces,
        color=_rgb(solid.colour),
        opacity=solid.opacity if solid.opacity < 1 else None,
        wxyz=_quaternion(rotation),
        position=place,
    )


def _rgb(colour: str) -> tuple[int, int, int]:
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return red, green, blue


def _quaternion(rotation: np.ndarray) -> np.ndarray:
    """Quaternion w x y z of a rotation `(3, 3)`."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(rotation).as_quat())[[3, 0, 1, 2]]
