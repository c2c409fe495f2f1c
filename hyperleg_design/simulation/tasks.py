"""Tasks: commands, observations, rewards and ends of episodes, read from a preset in `sim/` or a
user's file.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.reading import given_path, read_yaml
from hyperleg_design.robot.mjcf import TIME_STEP
from hyperleg_design.robot.names import SIDES
from hyperleg_design.robot.parameters import fields as parameter_fields
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.entries import check_keys, checked_mapping
from hyperleg_design.simulation import human_gait
from hyperleg_design.simulation.commands import VelocityCommands
from hyperleg_design.simulation.design_observation import DesignRanges, design_ranges
from hyperleg_design.simulation.settings import (
    Clock,
    Control,
    Limits,
    Physics,
    Randomisation,
    Start,
    Thermal,
)
from hyperleg_design.simulation.terms.observations import PARTS
from hyperleg_design.simulation.terms.rewards import TERMS
from hyperleg_design.simulation.waypoint_commands import WaypointCommands

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.simulation.layout import Layout

GROUPS = ("policy", "critic")
"""Observation groups that every task has."""
_SECTIONS: dict[str, Any] = {
    "physics": Physics,
    "control": Control,
    "start": Start,
    "limits": Limits,
    "thermal": Thermal,
    "clock": Clock,
    "randomisation": Randomisation,
}
_COMMANDS: dict[str, type[VelocityCommands] | type[WaypointCommands]] = {
    "velocity": VelocityCommands,
    "waypoints": WaypointCommands,
}


@dataclass(frozen=True)
class Reward:
    """Weight and parameters of one reward term in a task."""

    weight: float
    """The term is multiplied by it and by the policy step."""
    parameters: Mapping[str, float] = field(default_factory=dict)
    """Those of the term's function that differ from its defaults."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Task:
    """A task; everything that an environment needs besides the robot."""

    name: str
    commands: VelocityCommands | WaypointCommands
    observations: Mapping[str, tuple[str, ...]]
    """Parts of each observation group."""
    rewards: Mapping[str, Reward]
    """Reward terms with weight and parameters, by name."""
    physics: Physics = field(default_factory=Physics)
    control: Control = field(default_factory=Control)
    start: Start = field(default_factory=Start)
    limits: Limits = field(default_factory=Limits)
    thermal: Thermal = field(default_factory=Thermal)
    clock: Clock = field(default_factory=Clock)
    randomisation: Randomisation = field(default_factory=Randomisation)
    posture_deg: Mapping[str, float] = field(default_factory=dict)
    """Default posture by joint, both sides alike, in place of the design's [deg]: robots start in
    it and actions are added to it."""
    designs: DesignRanges | None = None
    """Ranges that designs are drawn from in training, for a task that observes the design."""

    def __post_init__(self) -> None:
        goal = isinstance(self.commands, WaypointCommands)
        for name, reward in self.rewards.items():
            check_reward(self.name, name, reward, goal)
        for group, parts in self.observations.items():
            for part in parts:
                if part not in PARTS:
                    raise InputError(
                        self.name,
                        f"observations.{group}",
                        part,
                        parameters.unknown(part, sorted(PARTS)),
                    )
                if PARTS[part].needs_goal and not goal:
                    raise InputError(
                        self.name, f"observations.{group}", part, "needs commands of kind waypoints"
                    )
        for group in GROUPS:
            if not self.observations.get(group):
                raise InputError(self.name, f"observations.{group}", None, "is missing or empty")
        if any("design" in parts for parts in self.observations.values()) != bool(self.designs):
            raise InputError(
                self.name, "designs", None, "must be there just where the part design is observed"
            )

    @property
    def deviations(self) -> dict[str, str]:
        """What is not the paper's: reward terms and weights, the gait clock where it is observed,
        and the simulation step, with descriptions.
        """
        deviations = {
            name: TERMS[name].description for name in self.rewards if not TERMS[name].paper
        }
        for name, weight in _paper_weights().items():
            if name in self.rewards and self.rewards[name].weight != weight:
                deviations[name] = (
                    f"weight {self.rewards[name].weight:g}, the paper's is {weight:g}"
                )
        if any("clock" in parts for parts in self.observations.values()):
            deviations["clock"] = (
                "gait clock in the observation"
                if self.clock.shown
                else "input for a gait clock, at zero under this task"
            )
        if self.physics.time_step != TIME_STEP:
            deviations["time_step"] = (
                f"simulation steps of {1e3 * self.physics.time_step:g} ms, "
                f"the paper's are {1e3 * TIME_STEP:g} ms"
            )
        return deviations

    def posed(self, design: RobotDesign) -> RobotDesign:
        """Put a design into the task's default posture.

        Args:
            design: a robot or batch.

        Returns:
            The design with other default angles; the same design where the task states none.

        Raises:
            InputError: a joint that the design does not have, or an angle outside its range.
        """
        if not self.posture_deg:
            return design
        values = {f"joints.{joint}.default_deg": v for joint, v in self.posture_deg.items()}
        return design.with_values(values, f"task {self.name}")

    def check_robot(self, layout: Layout, robot: str) -> None:
        """Whether a robot has all that the task's rewards and starting states name.

        Args:
            layout: of the robot.
            robot: its name, for the error.

        Raises:
            InputError: a reward term, or starts in mid-stride, for joints that the robot lacks.
        """
        needed = {
            f"rewards.{name}": (reward.weight, TERMS[name].needs_joints)
            for name, reward in self.rewards.items()
        }
        if self.start.stride_share:
            needed["start.stride_share"] = (self.start.stride_share, tuple(human_gait.KNOTS))
        for place, (value, joints) in needed.items():
            missing = [joint for joint in joints if joint not in layout.own_joints]
            if missing or (set(joints) == set(human_gait.KNOTS) and layout.limbs != SIDES):
                lacks = f"joints {', '.join(missing)}" if missing else "limbs left and right"
                other = "t_test_any" if isinstance(self.commands, WaypointCommands) else "walk_any"
                raise InputError(
                    f"task {self.name}",
                    place,
                    value,
                    f"is for robots with other joints: {robot} lacks {lacks}; leave it out, or use "
                    f"a task for any walker such as {other}",
                )

    def draws_later(self, duration: float) -> bool:
        """Decide whether running simulations draw random numbers after their start.

        Args:
            duration: time from the start that counts [s].

        Returns:
            True with pushes, commands that are drawn anew within that time, or waypoints without a
            course.
        """
        if isinstance(self.commands, WaypointCommands):
            drawn = self.commands.course_share < 1.0
        else:
            drawn = self.commands.interval < duration + 1.0
        return bool(drawn or self.randomisation.push_speed)

    def conditioned(self, designs: DesignRanges) -> Task:
        """Copy the task with the design observed in every observation group.

        Args:
            designs: ranges by which the observed numbers are scaled.

        Returns:
            The copy.
        """
        parts = {
            group: (*(part for part in parts if part != "design"), "design")
            for group, parts in self.observations.items()
        }
        return self.changed(observations=parts, designs=designs)

    def changed(self, **sections: Any) -> Task:
        """Copy the task with other sections.

        Args:
            sections: new values by name.

        Returns:
            The validated copy.
        """
        return dataclasses.replace(self, **sections)


def load_task(name: str | Path) -> Task:
    """Read a task from a shipped file or a file of the user.

    Args:
        name: a shipped name such as `walk`, or a YAML file.

    Returns:
        The validated task.

    Raises:
        InputError: names file, field, value and remedy.
    """
    path = resources.find_sim("task", name)
    return task_from_mapping(read_yaml(path), given_path(path))


@functools.cache
def _paper_weights() -> dict[str, float]:
    """Weights of the paper's Table II by reward term."""
    tasks = (load_task("walk_paper"), load_task("goal_paper"))
    return {n: r.weight for task in tasks for n, r in task.rewards.items() if TERMS[n].paper}


def task_from_mapping(data: Mapping[str, Any], where: str) -> Task:
    """Build a task from nested mappings, as YAML gives them.

    Args:
        data: sections by name.
        where: file, for error messages.

    Returns:
        The validated task.

    Raises:
        InputError: unknown or missing field, or a value that makes no sense.
    """
    check_keys(
        data,
        where,
        "",
        ("name", "commands", "observations", "rewards"),
        ("description", "posture_deg", "designs", *_SECTIONS),
    )
    sections: dict[str, Any] = {
        key: parameters.from_mapping(cls, data[key], where, key)
        for key, cls in _SECTIONS.items()
        if key in data
    }
    observations = {}
    for group, parts in checked_mapping(data["observations"], where, "observations").items():
        if not isinstance(parts, list):
            raise InputError(where, f"observations.{group}", parts, "expects a list of parts")
        observations[str(group)] = tuple(str(part) for part in parts)
    rewards = {
        str(term): _reward(entry, where, f"rewards.{term}")
        for term, entry in checked_mapping(data["rewards"], where, "rewards").items()
    }
    rule = parameter_fields.Rule("number", unit="deg", low=-180, high=180)
    posture = {
        str(joint): float(parameters.checked(angle, rule, where, f"posture_deg.{joint}"))
        for joint, angle in checked_mapping(
            data.get("posture_deg", {}), where, "posture_deg"
        ).items()
    }
    try:
        return Task(
            posture_deg=posture,
            designs=design_ranges(data["designs"], "designs") if "designs" in data else None,
            name=str(data["name"]),
            commands=_commands(data["commands"], where),
            observations=observations,
            rewards=rewards,
            **sections,
        )
    except InputError as error:
        raise InputError(where, error.field, error.value, error.remedy) from None


def _commands(data: Any, where: str) -> VelocityCommands | WaypointCommands:
    rest = dict(checked_mapping(data, where, "commands"))
    kind = rest.pop("kind", None)
    if kind not in _COMMANDS:
        raise InputError(where, "commands.kind", kind, f"expects one of {', '.join(_COMMANDS)}")
    courses = rest.pop("courses", [])
    if courses and kind != "waypoints":
        raise InputError(where, "commands.courses", courses, "needs kind: waypoints")
    share = (
        rest.pop("course_share", 0.0) if kind == "waypoints" else 0.0
    )  # checked together with the courses
    settings = parameters.from_mapping(_COMMANDS[kind], rest, where, "commands")
    if isinstance(settings, WaypointCommands):
        try:
            points = tuple(tuple((float(x), float(y)) for x, y in course) for course in courses)
        except (TypeError, ValueError):
            raise InputError(
                where,
                "commands.courses",
                courses,
                "expects a list of lists of points [x, y] in metres",
            ) from None
        return dataclasses.replace(settings, courses=points, course_share=share)
    return settings


def _reward(entry: Any, where: str, path: str) -> Reward:
    values = {"weight": entry} if not isinstance(entry, Mapping) else dict(entry)
    rule = parameter_fields.Rule("number")
    values = {str(k): parameters.checked(v, rule, where, f"{path}.{k}") for k, v in values.items()}
    if "weight" not in values:
        raise InputError(where, f"{path}.weight", None, "is missing")
    return Reward(values.pop("weight"), values)


def check_reward(where: str, name: str, reward: Reward, goal: bool) -> None:
    """Check that a reward can stand in a task.

    Args:
        where: file, for error messages.
        name: of the term.
        reward: its weight and parameters.
        goal: whether the task has waypoints.

    Raises:
        InputError: no such term or parameter, or a term that needs waypoints where there are none.
    """
    if name not in TERMS:
        raise InputError(
            where,
            f"rewards.{name}",
            reward.weight,
            parameters.unknown(name, sorted(TERMS)).replace("field", "term"),
        )
    term = TERMS[name]
    for key, value in reward.parameters.items():
        if key not in term.parameters:
            raise InputError(
                where,
                f"rewards.{name}.{key}",
                value,
                parameters.unknown(key, ["weight", *term.parameters]),
            )
    if term.needs_goal and not goal:
        raise InputError(
            where, f"rewards.{name}", reward.weight, "needs commands of kind waypoints"
        )
