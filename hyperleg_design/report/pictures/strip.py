"""Snapshots of one gait cycle of walks, with the force of the floor on each foot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.motion.gait import strides
from hyperleg_design.evaluation.motion.steps import measured_steps
from hyperleg_design.report.pictures.picture import Scene, Solid
from hyperleg_design.report.pictures.posing import level, posed, travel
from hyperleg_design.report.pictures.solids import PAD

if TYPE_CHECKING:
    from hyperleg_design.evaluation.rollout import Trial

_FORCE = "#2c7a4b"
SNAPSHOTS = 8
"""Number of snapshots of a strip, over one gait cycle from touchdown to touchdown of the right
foot."""
FORCE_LENGTH = 0.3
"""Length of an arrow for a force of one body weight [m]."""


def strip_scene(walks: Mapping[str, tuple[Trial, Any]], snapshots: int = SNAPSHOTS) -> Scene:
    """Draw snapshots of one gait cycle from the right side, with the floor's force on each foot and
    one row for each walk.

    Args:
        walks: by label: a walk and the `Events` by which its steps are told.
        snapshots: in a row, equal shares of the cycle apart, both ends among them.

    Returns:
        The scene.

    Raises:
        InputError: a walk without two strides of the right foot.
    """
    gap, row_height = 0.72, 1.24
    solids: list[Solid] = []
    labels, arrows, lines = [], [], []
    for row, (name, (trial, events)) in enumerate(walks.items()):
        begins, ends = strides(measured_steps(trial, events), 1)
        if len(begins) < 2:
            raise InputError(
                "strip", "strides", len(begins), f"{name} has too few strides to show one"
            )
        middle = len(begins) // 2
        samples = np.linspace(begins[middle], ends[middle], snapshots).round().astype(int)
        samples = np.minimum(samples, trial.samples - 1)
        place, turn = level(trial, samples, travel(trial, samples))
        shift = np.stack(
            [gap * np.arange(snapshots), np.zeros(snapshots), place[:, 2] - row * row_height], -1
        )
        height = -row * row_height
        kinds, rotations, positions = posed(trial, samples, turn, shift)
        for i in range(snapshots):
            for solid, rotation, position in zip(kinds, rotations[i], positions[i], strict=True):
                solids.append(
                    Solid(solid.kind, solid.size, rotation, position, solid.colour, solid.opacity)
                )
            arrows += _force_arrows(
                trial, int(samples[i]), kinds, positions[i], travel(trial, samples), height
            )
            labels.append(
                (
                    np.array([gap * i - 0.05, -0.5, height - 0.07]),
                    f"{round(100 * i / (snapshots - 1))} %",
                    "#555555",
                )
            )
        lines.append(
            (
                np.array([-0.45, 0, height]),
                np.array([gap * (snapshots - 1) + 0.42, 0, height]),
                "#8b93a1",
                2.0,
            )
        )
        labels.append((np.array([-0.45, -0.5, height + 1.04]), name, "#1d2129"))
    width, count = gap * (snapshots - 1) + 0.95, len(walks)
    total = row_height * count + 0.06
    focus = (gap * (snapshots - 1) / 2 - 0.01, 0.0, row_height - total / 2 - 0.13 + 0.03)
    return Scene(
        tuple(solids),
        tuple(lines),
        tuple(labels),
        tuple(arrows),
        camera=((focus[0], -4.0, focus[2]), focus),
        height=total,
        size=(1500, int(1500 * total / width)),
        font=20,
    )


def _force_arrows(
    trial: Trial,
    sample: int,
    kinds: Sequence[Solid],
    positions: np.ndarray,
    heading: np.ndarray,
    floor: float,
) -> list[Any]:
    """Force on each foot at its centre of pressure, one body weight `FORCE_LENGTH` long, in the
    plane of the picture.
    """
    pads = [i for i, solid in enumerate(kinds) if solid.kind == "sphere" and solid.colour == PAD]
    if len(pads) != len(trial.layout.pads):
        return []
    arrows = []
    for foot in range(len(trial.layout.feet)):
        mine = trial.layout.pad_foot == foot
        force = trial.pad_force[sample, mine]
        if force[:, 2].sum() < 0.05 * trial.layout.weight:
            continue
        places = positions[np.array(pads)[mine]]
        centre = (places * force[:, 2:]).sum(0) / force[:, 2].sum()
        total = force.sum(0)
        vector = (
            FORCE_LENGTH
            / trial.layout.weight
            * np.array([float(heading @ total[:2]), 0.0, float(total[2])])
        )
        arrows.append((np.array([centre[0], -0.3, floor]), vector, _FORCE))
    return arrows
