"""Tasks and presets as plain mappings, every value written out, so that a file says by itself what
was trained.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from hyperleg_design.robot.parameters import fields as parameter_fields
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.simulation.settings import in_use
from hyperleg_design.simulation.tasks import _SECTIONS
from hyperleg_design.simulation.waypoint_commands import WaypointCommands

if TYPE_CHECKING:
    from hyperleg_design.learning.preset import Preset, Ramp, Stage
    from hyperleg_design.simulation.tasks import Task


def task_mapping(task: Task) -> dict[str, Any]:
    """Write a task out as nested mappings.

    Args:
        task: the task.

    Returns:
        A mapping from which `task_from_mapping` builds the same task.
    """
    commands: dict[str, Any] = {
        "kind": "waypoints" if isinstance(task.commands, WaypointCommands) else "velocity"
    }
    commands.update(_section(task.commands))
    if isinstance(task.commands, WaypointCommands):
        commands["courses"] = [
            [list(point) for point in course] for course in task.commands.courses
        ]
    return {
        "name": task.name,
        "commands": commands,
        "observations": {group: list(parts) for group, parts in task.observations.items()},
        "rewards": {term: {"weight": r.weight, **r.parameters} for term, r in task.rewards.items()},
        **{section: _section(getattr(task, section)) for section in _SECTIONS},
        **({"posture_deg": dict(task.posture_deg)} if task.posture_deg else {}),
        **({"designs": task.designs.to_mapping()} if task.designs else {}),
    }


def _section(section: Any) -> dict[str, Any]:
    """Leaves of a section without later settings that are not used, so that trainings from before
    there were such settings go on.
    """
    return in_use(parameters.leaves(section))


def preset_mapping(preset: Preset, task: str) -> dict[str, Any]:
    """Write a preset with the stages of one task out as nested mappings.

    Args:
        preset: the preset.
        task: name of the task.

    Returns:
        A mapping from which `preset_from_mapping` builds the same preset.
    """
    mapping: dict[str, Any] = {"name": preset.name}
    for field in dataclasses.fields(preset):
        if parameter_fields.is_leaf(field):
            mapping[field.name] = getattr(preset, field.name)
    mapping["algorithm"] = parameters.leaves(preset.algorithm)
    mapping["network"] = {
        "hidden": list(preset.network.hidden),
        **parameters.leaves(preset.network),
    }
    if preset.network.modulated:
        del mapping["network"]["modulated"]  # the default; older trainings do not name it
    mapping["warm_start"] = parameters.leaves(preset.warm_start)
    mapping["tasks"] = {task: [_stage(stage) for stage in preset.stages(task)]}
    return mapping


def _stage(stage: Stage) -> dict[str, Any]:
    mapping: dict[str, Any] = {
        "name": stage.name,
        "steps": stage.steps,
        "assist_gone_by": stage.assist_gone_by,
    }
    if stage.assist is not None:
        mapping["assist"] = stage.assist
    mapping["rewards"] = {term: _plain(values) for term, values in stage.rewards.items()}
    mapping["commands"] = _plain(stage.commands)
    mapping["ramps"] = [_ramp(ramp) for ramp in stage.ramps]
    return mapping


def _ramp(ramp: Ramp) -> dict[str, Any]:
    target = ".".join(part for part in ramp.target if part)
    return {
        "set": target,
        "from": ramp.low,
        "to": ramp.high,
        "steps": ramp.steps,
        "begins": ramp.begins,
    }


def _plain(values: Mapping[str, float]) -> dict[str, float]:
    return dict(values)
