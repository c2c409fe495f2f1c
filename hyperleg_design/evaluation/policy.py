"""Policies: plain callables from observations `(n, size)` to actions `(n, J)`, or ONNX files that
say what they are.

`simulation/policy_file.py` lists what such a file holds.

A callable with a method `reset(n)` is told before each evaluation that n trials begin.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.evaluation.shipped import find_policy
from hyperleg_design.reading import given_path, short_name
from hyperleg_design.robot.load import robot_from_mapping
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.policy_file import INPUT, OUTPUT, POLICY_FORMAT
from hyperleg_design.simulation.tasks import task_from_mapping

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.simulation.environment import Environment
    from hyperleg_design.simulation.tasks import Task

NEEDED = ("columns", "joints", "task", "design")
"""Metadata without which a file is not evaluated."""

Policy = Callable[[np.ndarray], np.ndarray]
"""A function from observations `(n, size)` to actions `(n, J)`."""


@dataclass(eq=False)
class OnnxPolicy:
    """A policy from an ONNX file, run by ONNX Runtime on one thread, so that results do not depend
    on the machine's load.
    """

    name: str
    """Folder and name of the file, without its ending."""
    columns: tuple[str, ...]
    """Names of the numbers of the observation."""
    joints: tuple[str, ...]
    """Names of the numbers of the action."""
    design: RobotDesign
    """The robot that it was trained on."""
    task: Task
    """The task that it was trained on, as it began."""
    metadata: Mapping[str, Any]
    """All that the file says of itself."""
    session: Any = field(repr=False)
    """Session of ONNX Runtime."""

    def __call__(self, observation: np.ndarray) -> np.ndarray:
        """Actions `(n, J)` for observations `(n, size)`."""
        (action,) = self.session.run([OUTPUT], {INPUT: np.asarray(observation, np.float32)})
        return np.asarray(action)

    @property
    def seed(self) -> int:
        """Training seed; -1 where the file does not say."""
        return _whole(self.metadata.get("seed"))

    @property
    def steps(self) -> int:
        """Policy steps that it was trained for; -1 where the file does not say."""
        return _whole(self.metadata.get("steps"))

    @property
    def variant(self) -> str:
        """Ablation that it was trained on."""
        return self.design.variant


def load_policy(name: str | Path) -> OnnxPolicy:
    """Read a trained policy, with all that its file says of its training.

    Args:
        name: an ONNX file, or the name of a shipped training, such as `walk_upright-toe-1`.

    Returns:
        A policy that maps observations to actions and knows its design and task.

    Raises:
        InputError: missing, truncated or foreign file, or metadata that does not fit its graph.
    """
    path = find_policy(name)
    where = given_path(path)
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(where, "", None, f"cannot be read ({error.strerror})") from None
    session = _session(content, where)
    metadata = _metadata(session, where)
    columns, joints = (_names(metadata[key], where, key) for key in ("columns", "joints"))
    _check_graph(session, where, len(columns), len(joints))
    return OnnxPolicy(
        name=short_name(path.with_suffix("")),
        columns=columns,
        joints=joints,
        design=robot_from_mapping(metadata["design"], f"{where}: design"),
        task=task_from_mapping(metadata["task"], f"{where}: task"),
        metadata=metadata,
        session=session,
    )


def standing(joints: int) -> Policy:
    """Make a policy that holds the default posture.

    Args:
        joints: number of joints.

    Returns:
        A callable that returns zeros `(n, joints)` for observations `(n, k)`.
    """
    return lambda observation: np.zeros((len(observation), joints))


def policy_name(policy: Policy) -> str:
    """Name a policy for messages and tables.

    Args:
        policy: any policy.

    Returns:
        Its attribute `name`, else the name of the function or class.
    """
    return str(
        getattr(policy, "name", None) or getattr(policy, "__name__", type(policy).__name__)
    ).replace("<lambda>", "policy")


def check_layout(policy: Policy, environment: Environment) -> None:
    """Check that a policy that knows its layout was made for this robot and task.

    Args:
        policy: an ONNX policy; any other callable passes.
        environment: gives the columns of the observation and the joints.

    Raises:
        InputError: names the first number that is another one.
    """
    if isinstance(policy, OnnxPolicy):
        columns = environment.observation_columns["policy"]
        _same(policy, "columns", policy.columns, columns, environment.designs[0])


def check_joints(policy: Policy, design: RobotDesign) -> None:
    """Check that a policy that knows its joints was made for a robot with the same ones.

    Args:
        policy: an ONNX policy; any other callable passes.
        design: a robot or batch.

    Raises:
        InputError: names the first joint that is another one.
    """
    if isinstance(policy, OnnxPolicy):
        robot = design.take(0) if design.batch_shape else design
        _same(policy, "joints", policy.joints, layout_of(robot).joints, robot)


def _same(
    policy: OnnxPolicy, key: str, own: Sequence[str], needed: Sequence[str], design: RobotDesign
) -> None:
    difference = _first_difference(own, needed)
    if difference:
        trained, present = (robot.variant or robot.name for robot in (policy.design, design))
        raise InputError(
            policy.name,
            key,
            None,
            f"the policy, trained on {trained}, is made for another layout than {present} and this "
            f"task have: {difference}; expects a policy of {present}",
        )


def checked_action(
    policy: Policy,
    observation: np.ndarray,
    step: int,
    duration: float,
    running: np.ndarray,
    size: int,
) -> np.ndarray:
    """Compute the actions of a policy for the trials that still run.

    Args:
        policy: the policy.
        observation: `(n, k)`.
        step: policy step, for messages.
        duration: of a policy step [s].
        running: trials that count, `(n,)`.
        size: numbers in an action.

    Returns:
        The actions, `(n, size)`; zero for trials that have ended.

    Raises:
        InputError: wrong shape, or values that are not finite; names step and trial.
    """
    action = np.asarray(policy(observation), float)
    if action.shape != (len(observation), size):
        expected = (len(observation), size)
        raise InputError(
            policy_name(policy),
            OUTPUT,
            action.shape,
            f"must have the shape {expected}; is the policy made for another robot?",
        )
    bad = np.flatnonzero(~np.isfinite(action).all(-1) & running)
    if len(bad):
        place = f"in policy step {step} ({step * duration:.2f} s) of trial {bad[0]}"
        raise InputError(
            policy_name(policy), OUTPUT, action[bad[0]].tolist(), f"is not finite {place}"
        )
    return np.where(running[:, None], action, 0.0)


def _session(content: bytes, where: str) -> Any:
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    try:
        return onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
    except Exception as error:  # ONNX Runtime's errors share no base of their own
        reason = in_short(error, 120)
        raise InputError(
            where, "", None, f"is no whole ONNX file ({reason}); export it again"
        ) from None


def _metadata(session: Any, where: str) -> dict[str, Any]:
    raw = dict(session.get_modelmeta().custom_metadata_map)
    if raw.get("format") != POLICY_FORMAT:
        remedy = (
            f"expects {POLICY_FORMAT}; export with `hyperleg train`, or wrap a foreign network in "
            f"a callable"
        )
        raise InputError(where, "format", raw.get("format"), remedy)
    metadata: dict[str, Any] = {}
    for key, text in raw.items():
        try:
            metadata[key] = json.loads(text)
        except ValueError:
            metadata[key] = text
    for key in NEEDED:
        if key not in metadata:
            raise InputError(
                where, key, None, "is missing in the metadata; export the policy again"
            )
    for key in ("task", "design"):
        if not isinstance(metadata[key], dict):
            raise InputError(
                where,
                key,
                metadata[key],
                "expects a mapping in the metadata; export the policy again",
            )
    return metadata


def _check_graph(session: Any, where: str, columns: int, joints: int) -> None:
    places = (
        (INPUT, session.get_inputs(), columns, "columns"),
        (OUTPUT, session.get_outputs(), joints, "joints"),
    )
    for name, actual, size, key in places:
        if [f.name for f in actual] != [name]:
            raise InputError(
                where, name, [f.name for f in actual], f"expects one tensor named {name}"
            )
        shape = actual[0].shape
        if len(shape) != 2 or (isinstance(shape[1], int) and shape[1] != size):
            raise InputError(where, name, list(shape), f"does not fit the metadata: {size} {key}")


def _names(value: Any, where: str, key: str) -> tuple[str, ...]:
    if not isinstance(value, list) or not value or not all(isinstance(v, str) for v in value):
        raise InputError(
            where, key, value, "expects a list of names in the metadata; export the policy again"
        )
    return tuple(value)


def _first_difference(own: Sequence[str], needed: Sequence[str]) -> str:
    for i, (a, b) in enumerate(zip(own, needed, strict=False)):
        if a != b:
            return f"number {i} is {a} instead of {b}"
    return f"{len(own)} numbers instead of {len(needed)}" if len(own) != len(needed) else ""


def _whole(value: Any) -> int:
    try:
        return int(value)
    except (TypeError, ValueError):
        return -1
