"""Models and layouts of the designs that an environment simulates."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING

from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.simulation.alteration import Alteration
from hyperleg_design.simulation.layout import Layout, layout_of
from hyperleg_design.simulation.model import simulated_robots, simulation_model
from hyperleg_design.simulation.surroundings import UnevenFloor
from hyperleg_design.simulation.tasks import Task

if TYPE_CHECKING:
    import mujoco

    from hyperleg_design.robot.parameters.described import RobotDesign


def robots_of(
    designs: Sequence[RobotDesign], task: Task, alterations: Sequence[Alteration], seed: int = 0
) -> list[tuple[mujoco.MjModel, Layout]]:
    """Compile the designs for a task.

    Args:
        designs: the robots, one each, in the task's posture.
        task: gives the physics, the floor, and what is observed of a design.
        alterations: of each of the robots.
        seed: of an uneven floor.

    Returns:
        MuJoCo model of each design, shared between callers and not to be written into, and its
        layout.
    """
    if task.randomisation.uneven_floor:
        alterations = (UnevenFloor(task.randomisation.uneven_floor, seed), *alterations)
    if not alterations:
        robots = list(simulated_robots(designs, task.physics))
    else:
        robots = [
            (simulation_model(robot, task.physics, alterations), layout_of(robot))
            for robot in designs
        ]
    if any(alteration.edits for alteration in alterations):
        robots = [
            (
                model,
                dataclasses.replace(layout, weight=float(model.body_mass.sum()) * GRAVITY),
            )
            for model, layout in robots
        ]
    if task.designs is not None:
        ranges = task.designs
        robots = [
            (
                model,
                dataclasses.replace(
                    layout,
                    observed=ranges.numbers(robot),
                    observed_names=tuple(ranges.columns),
                ),
            )
            for (model, layout), robot in zip(robots, designs, strict=True)
        ]
    return robots
