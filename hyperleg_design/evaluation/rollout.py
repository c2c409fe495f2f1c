"""Trials of a policy, side by side, with every signal that measures need."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.policy import (
    OnnxPolicy,
    Policy,
    check_layout,
    checked_action,
    policy_name,
)
from hyperleg_design.evaluation.signal_blocks import SignalBlocks
from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.simulation.drives.told import TOLD
from hyperleg_design.simulation.stepping.record import signals_of
from hyperleg_design.simulation.terms import terminations

if TYPE_CHECKING:
    import mujoco

    from hyperleg_design.evaluation.motion.motor_use import MotorUse
    from hyperleg_design.evaluation.motion.power import CyclePower
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.simulation.environment import Environment
    from hyperleg_design.simulation.layout import Layout
    from hyperleg_design.simulation.stepping.chunk import Chunk
    from hyperleg_design.simulation.stepping.step import Divergence
    from hyperleg_design.simulation.tasks import Task

ARRIVED, TIMED_OUT, FELL, LOST, DIVERGED = "arrived", "timed_out", "fell", "lost", "diverged"
OUTCOMES = (ARRIVED, TIMED_OUT, FELL, LOST, DIVERGED)
"""How a trial can end."""
_OF_ENDING = {
    terminations.LOW: FELL,
    terminations.TILTED: FELL,
    terminations.TIME_OUT: TIMED_OUT,
    terminations.OFF_PATH: LOST,
    terminations.COURSE_FINISHED: ARRIVED,
    terminations.DIVERGED: DIVERGED,
}


@dataclass(frozen=True, eq=False)
class Trial:
    """One trial's signals at the start of each simulation step; time first."""

    design: RobotDesign
    layout: Layout
    model: mujoco.MjModel
    """MuJoCo model that was simulated."""
    time_step: float
    """Time between samples [s]."""
    substeps: int
    """Samples in a policy step."""
    outcome: str
    """One of `OUTCOMES`."""
    end_time: float
    """Time at which the trial ended [s]; the policy step of a fall or an arrival is counted, and
    its samples are left out."""
    base_position: np.ndarray
    """Position of the pelvis [m], `(t, 3)`."""
    base_orientation: np.ndarray
    """w x y z, `(t, 4)`."""
    base_velocity: np.ndarray
    """Velocity of the pelvis in the world [m/s], `(t, 3)`."""
    joint_position: np.ndarray
    """Joint angles [rad], `(t, J)`."""
    joint_velocity: np.ndarray
    """Joint speeds [rad/s], `(t, J)`."""
    driven_joint_torque: np.ndarray
    """M times the motor torque, before friction [Nm], `(t, J)`."""
    motor_torque: np.ndarray
    """Motor torques [Nm], `(t, K)`."""
    motor_velocity: np.ndarray
    """Motor speeds [rad/s], `(t, K)`."""
    pad_force: np.ndarray
    """Force of the floor on each pad, in the world [N], `(t, P, 3)`."""
    pad_slip: np.ndarray
    """Sliding speed of each touching pad [m/s], `(t, P)`."""
    stop_torque: np.ndarray | None = None
    """Torque on the joints of the stops at the ends of the range of motion [Nm], `(t, J)`; None
    where it was not recorded."""
    divergence: Divergence | None = None
    """State from which it diverged, where it did."""
    joint_target: np.ndarray | None = None
    """Angles that the joint controllers were asked for [rad], `(t, J)`; None where nobody recorded
    them."""
    base_angular_velocity: np.ndarray | None = None
    """Angular velocity of the pelvis in its own frame [rad/s], `(t, 3)`; None where it was not
    recorded."""
    power_constant: np.ndarray | None = None
    """Joule heat over squared torque of each motor [W/Nm^2], `(K,)`, where alterations make it
    another than the design's."""
    told: Mapping[str, np.ndarray] = field(default_factory=dict)
    """What drives and sensors told, where alterations make that another thing; see
    `simulation.drives.told.Told`."""

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, `(J,)`."""
        return self.layout.joints

    @property
    def samples(self) -> int:
        """Number of samples in each signal."""
        return len(self.base_position)

    @property
    def mass(self) -> float:
        """Mass of the simulated robot [kg]."""
        return self.layout.weight / GRAVITY

    @property
    def pad_load(self) -> np.ndarray:
        """Vertical force on each pad [N], `(t, P)`."""
        return self.pad_force[..., 2]

    @cached_property
    def foot_load(self) -> np.ndarray:
        """Vertical force on each foot [N], `(t, F)`; of a biped left and right."""
        return np.stack(
            [
                self.pad_load[:, self.layout.pad_foot == foot].sum(-1)
                for foot in range(len(self.layout.feet))
            ],
            -1,
        )


SIGNALS = (
    "base_position",
    "base_orientation",
    "base_velocity",
    "base_angular_velocity",
    "joint_target",
    "joint_position",
    "joint_velocity",
    "driven_joint_torque",
    "stop_torque",
    "motor_torque",
    "motor_velocity",
    "pad_force",
    "pad_slip",
)
"""Signals of `Environment.signals` that a `Trial` keeps."""


Measured: TypeAlias = "tuple[dict[str, float], MotorUse | None, CyclePower | None]"
"""Measures of one trial by name, the use of its motors, and its power over the gait cycle."""


@dataclass(frozen=True)
class ProtocolRun:
    """How trials of one policy's task are run and measured under one protocol."""

    task: Task
    """The policy's task with the commands, starting states and time of the protocol."""
    measure: Callable[[Trial], Measured]
    """Computes the measures of one trial."""
    arrived: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None
    """Tells which trials have arrived, `(n,)`, from the first and the present positions of the
    pelvis, `(n, 3)` [m]; None where the task itself ends a trial that arrives."""
    before_step: Callable[[Environment], None] | None = None
    """Is called before each step of the policy, to set commands that depend on the state."""


def record(
    policy: Policy,
    environment: Environment,
    time_limit: float,
    *,
    arrived: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None,
    before_step: Callable[[Environment], None] | None = None,
) -> list[Trial]:
    """Run every simulation of an environment once, without assist, to its end or the time limit.

    Args:
        policy: from observations of the group `policy` to actions.
        environment: without assist; its episodes must not time out before the limit.
        time_limit: longest duration of a trial [s].
        arrived: from first and latest pelvis positions `(n, 3)` to whether each trial is done; a
            trial may also end by itself.
        before_step: called before each policy step, to set commands.

    Returns:
        The record of each trial, in the order of the simulations.

    Raises:
        InputError: a policy for another layout, or whose output has a wrong shape or is not finite.
    """
    check_layout(policy, environment)
    count, duration = environment.simulations, environment.task.physics.policy_step
    limit = round(time_limit / duration)
    environment.assist = None
    environment.recording, environment.rewarded = True, False
    # the results are the same with and without; only time is saved
    freezing = not environment.draws_later(time_limit)
    observation = environment.reset()["policy"]
    if hasattr(policy, "reset"):
        policy.reset(count)
    running = np.ones(count, bool)
    length, ended_at = np.zeros(count, int), np.zeros(count)
    outcomes = [TIMED_OUT] * count
    divergences: dict[int, Divergence] = {}
    blocks = SignalBlocks()
    first = np.concatenate([chunk.motion.position for chunk in environment.chunks])
    for step_index in range(limit):
        action = checked_action(
            policy, observation, step_index, duration, running, environment.action_size
        )
        if before_step is not None:
            before_step(environment)
        step = environment.step(action)
        observation = step.observations["policy"]
        blocks.keep([chunk.samples() for chunk in environment.chunks], running)
        divergences.update({d.simulation: d for d in step.divergences if running[d.simulation]})
        ended = step.ended[running[step.ended]]
        for trial in ended:
            outcomes[trial] = _OF_ENDING[int(step.ending[trial])]
            length[trial], ended_at[trial] = step_index, (step_index + 1) * duration
        over = [ended]
        running[ended] = False
        if arrived is not None:
            rows, state = blocks.latest("state")
            done = rows[running[rows] & arrived(first[rows], state[:, :3])]
            for trial in done:
                outcomes[trial] = ARRIVED
            length[done] = step_index + 1
            ended_at[done] = (step_index + 1) * duration
            running[done] = False
            over.append(done)
        if not running.any():
            break
        if freezing and any(map(len, over)):
            environment.freeze(np.concatenate(over))
    length[running], ended_at[running] = limit, limit * duration
    samples = {name: blocks.taken(name, length) for name in blocks.names}
    trials = []
    for chunk in environment.chunks:
        matrix = chunk.drive.model.joint_from_motor
        for row in range(chunk.count):
            i = chunk.first + row
            own = environment.design_index[i]
            signals = signals_of(
                {name: each.pop(0) for name, each in samples.items()},
                environment.layouts[own],
                matrix if matrix.ndim == 2 else matrix[row],
            )
            trial = Trial(
                design=environment.designs[own],
                layout=environment.layouts[own],
                model=environment.models[own],
                time_step=environment.task.physics.time_step,
                substeps=int(environment.task.physics.substeps),
                outcome=outcomes[i],
                end_time=float(ended_at[i]),
                divergence=divergences.get(i),
                power_constant=_power_constant(chunk, row),
                told={name: values for name, values in signals.items() if name.startswith(TOLD)},
                **{name: signals[name] for name in SIGNALS},
            )
            trials.append(trial)
    return trials


def _power_constant(chunk: Chunk, row: int) -> np.ndarray | None:
    """Power constants of one simulation's motors where alterations changed them, `(K,)`."""
    chain = chunk.drive.chain
    if chain is None or chain.machine.power_constant is chain.nominal.power_constant:
        return None
    altered = chain.machine.power_constant
    return np.array(np.broadcast_to(altered, (chunk.count, altered.shape[-1]))[row])


def resolved(
    policy: Policy, design: RobotDesign | None, task: Task | None
) -> tuple[RobotDesign, Task]:
    """Choose the robot and the task of an evaluation.

    Args:
        policy: an ONNX policy has a robot and a task of its own.
        design: the robot; the policy's own by default.
        task: the policy's own by default.

    Returns:
        The robot and the task.

    Raises:
        InputError: a plain callable without either.
    """
    own = policy if isinstance(policy, OnnxPolicy) else None
    design, task = design or (own.design if own else None), task or (own.task if own else None)
    for name, value in (("design", design), ("task", task)):
        if value is None:
            raise InputError(
                policy_name(policy),
                name,
                None,
                "is needed with a policy that is not an ONNX file of this package",
            )
    assert design is not None
    assert task is not None
    return design, task


def under_protocol(task: Task, protocol: Any) -> Task:
    """Put a task under the starting states, differences between robots and time of a protocol.

    Args:
        task: the policy's task.
        protocol: of either kind.

    Returns:
        The changed task; its episodes last twice the protocol's time limit, so that none ends
        first.
    """
    limits = dataclasses.replace(task.limits, duration=2 * protocol.time_limit)
    return task.changed(start=protocol.start, randomisation=protocol.randomisation, limits=limits)


def outcome_measures(trial: Trial) -> dict[str, float]:
    """State how a trial ended, as measures.

    Args:
        trial: the recorded trial.

    Returns:
        `fell`, `lost`, `timed_out` and `diverged`, each 0 or 1.
    """
    return {name: float(trial.outcome == name) for name in (FELL, LOST, TIMED_OUT, DIVERGED)}
