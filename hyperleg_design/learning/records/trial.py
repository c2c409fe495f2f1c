"""A short test of a policy while it is trained: deterministic, without assist, from standing.

The evaluation protocols judge policies; this only shows how a training gets on.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.learning.records.meter import mean_speed
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.model import pad_loads
from hyperleg_design.simulation.tasks import Reward, Task
from hyperleg_design.simulation.terms.rewards import TOUCH
from hyperleg_design.simulation.terms.terminations import COURSE_FINISHED
from hyperleg_design.simulation.waypoint_commands import WaypointCommands

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.simulation.alteration import Alterations

Policy = Callable[[np.ndarray], np.ndarray]
"""A function from observations of the group `policy`, `(n, size)`, to actions, `(n, J)`."""
WALK = 12.0
"""Length of a walking trial [s]; its second half is measured."""
COURSE = 30.0
"""Time given to a course [s]."""


def trial(
    design: RobotDesign,
    task: Task,
    policy: Policy,
    *,
    simulations: int = 32,
    seed: int = 0,
    alterations: Alterations | None = None,
) -> dict[str, float]:
    """Try a policy from standing: on the test's speed, or on the first of the task's courses.

    Args:
        design: the robot; or a batch of designs, each tried equally often.
        task: it was trained on.
        policy: deterministic.
        simulations: robots that try, once each.
        seed: of the starting states.
        alterations: of the simulated robot, or what makes them for a design.

    Returns:
        Walking: `survival`, `speed` [m/s], `speed_error` (RMS over robots and time [m/s]),
        `cost_of_transport`, `cadence` [steps/s], `double_support` and `flight` (fractions of time
        with all feet and with none on the floor).
        Courses: `finished` (fraction), `time` (mean of the finished [s]), `survival`, `speed`.
    """
    goal = isinstance(task.commands, WaypointCommands)
    task = task.changed(start=dataclasses.replace(task.start, stride_share=0.0))
    return (_course if goal else _walk)(design, task, policy, simulations, seed, alterations)


def _walk(
    design: RobotDesign,
    task: Task,
    policy: Policy,
    simulations: int,
    seed: int,
    alterations: Alterations | None,
) -> dict[str, float]:
    given: Any = task.commands
    commands = dataclasses.replace(given, test_share=1.0, standing_share=0.0)
    task = task.changed(commands=commands, rewards={**task.rewards, "power": Reward(1.0)})
    environment = Environment(
        design, task, simulations=simulations, seed=seed, threads=1, alterations=alterations
    )
    duration, steps = task.physics.policy_step, round(WALK / task.physics.policy_step)
    observations, alive = environment.reset(), np.ones(simulations, bool)
    speeds, powers, stands = [], [], []
    for _ in range(steps):
        step = environment.step(policy(observations["policy"]))
        observations = step.observations
        alive[step.ended] = False
        speeds.append(np.concatenate([c.motion.walking_velocity[:, 0] for c in environment.chunks]))
        powers.append(step.reward_terms[:, environment.reward_names.index("power")] / duration)
        stands.append(_stands(environment))
    environment.close()
    second = slice(steps // 2, None)
    speed, power, stand = (
        np.array(values)[second][:, alive] for values in (speeds, powers, stands)
    )
    if not alive.any():
        nothing = (
            "speed",
            "speed_error",
            "cost_of_transport",
            "cadence",
            "double_support",
            "flight",
        )
        return {"survival": 0.0, **dict.fromkeys(nothing, float("nan"))}
    weight = np.broadcast_to(environment.layout.weight, (simulations,))
    touchdowns = (stand[1:] & ~stand[:-1]).sum((0, 2))
    return {
        "survival": float(alive.mean()),
        "speed": float(speed.mean()),
        "speed_error": float(np.sqrt(np.mean((speed - commands.test_speed) ** 2))),
        "cost_of_transport": float(power.mean() / (weight[alive].mean() * max(speed.mean(), 1e-3))),
        "cadence": float(touchdowns.mean() / (len(stand) * duration)),
        "double_support": float(stand.all(-1).mean()),
        "flight": float((~stand.any(-1)).mean()),
    }


def _stands(environment: Environment) -> np.ndarray:
    """Whether each foot stands, `(n, F)`."""
    load = np.concatenate([pad_loads(chunk.sensors[-1]) for chunk in environment.chunks])
    owner = environment.layout.pad_foot
    feet = range(len(environment.layout.feet))
    return np.stack([load[:, owner == foot].sum(-1) for foot in feet], -1) > TOUCH


def _course(
    design: RobotDesign,
    task: Task,
    policy: Policy,
    simulations: int,
    seed: int,
    alterations: Alterations | None,
) -> dict[str, float]:
    limits = dataclasses.replace(task.limits, duration=2 * COURSE)
    given: Any = task.commands
    first = dataclasses.replace(given, course_share=1.0, courses=given.courses[:1])
    task = task.changed(commands=first, limits=limits)
    environment = Environment(
        design, task, simulations=simulations, seed=seed, threads=1, alterations=alterations
    )
    duration = task.physics.policy_step
    observations, running = environment.reset(), np.ones(simulations, bool)
    times, finished = np.full(simulations, np.nan), np.zeros(simulations, bool)
    fallen, speeds = np.zeros(simulations, bool), []
    for k in range(round(COURSE / duration)):
        step = environment.step(policy(observations["policy"]))
        observations = step.observations
        ended = step.ended[running[step.ended]]
        done = ended[step.ending[ended] == COURSE_FINISHED]
        times[done], finished[done] = (k + 1) * duration, True
        fallen[ended] |= step.terminated[ended]
        running[ended] = False
        speeds.append(mean_speed(environment, goal=True))
        if not running.any():
            break
    environment.close()
    return {
        "finished": float(finished.mean()),
        "time": float(times[finished].mean()) if finished.any() else float("nan"),
        "survival": float(1.0 - fallen.mean()),
        "speed": float(np.mean(speeds)),
    }
