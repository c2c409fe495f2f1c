from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.learning.preset import Preset

torch = pytest.importorskip("torch")
onnx = pytest.importorskip("onnx")
ort = pytest.importorskip("onnxruntime")
pytest.importorskip("rsl_rl")
pytest.importorskip("tensorboard")

from hyperleg_design.learning.learner.algorithm import as_tensors  # noqa: E402
from hyperleg_design.learning.policies.start_policy import read_start  # noqa: E402
from hyperleg_design.learning.preset import WarmStart  # noqa: E402
from hyperleg_design.learning.preset_file import load_preset  # noqa: E402
from hyperleg_design.learning.train import describe, train  # noqa: E402
from hyperleg_design.learning.training import Training  # noqa: E402
from hyperleg_design.robot.design import load_design  # noqa: E402
from hyperleg_design.robot.load import load_robot  # noqa: E402
from hyperleg_design.robot.parameters.described import RobotDesign  # noqa: E402
from hyperleg_design.simulation.design_observation import (  # noqa: E402
    DesignRanges,
    Range,
    design_ranges,
)
from hyperleg_design.simulation.design_spread import DesignSpread  # noqa: E402
from hyperleg_design.simulation.tasks import Task, load_task  # noqa: E402


@pytest.fixture(scope="module")
def walker(tiny: Preset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("walker")
    assert train("walk", "toe", 0, tiny, folder)
    return folder / "policy.onnx"


def begun(
    tiny: Preset, walker: Path, folder: Path, design: str = "toe", task: str | Task = "goal"
) -> Training:
    task, robot = load_task(task) if isinstance(task, str) else task, load_design(design)
    start = read_start(walker)
    description = {**describe(task, robot, 0, tiny), "start": start.source}
    return Training(task, robot, 0, tiny, folder, 1, description, start)


def begun_from_checkpoint(tiny: Preset, folder: Path) -> Training:
    task, robot = load_task("goal"), load_design("toe")
    return Training(task, robot, 0, tiny, folder, 1, describe(task, robot, 0, tiny))


@pytest.mark.parametrize("task", ["walk_upright", "t_test_free"])
def test_a_clock_that_was_no_longer_shown_is_left(tiny: Preset, tmp_path: Path, task: str) -> None:
    """A policy without the clock does what the old one does where the clock is zero."""
    stages = tiny.stages("walk")
    plain = tuple(dataclasses.replace(s, rewards={}, commands={}, ramps=()) for s in stages)
    preset = dataclasses.replace(tiny, tasks={"walk_guided": plain, task: plain})
    assert train("walk_guided", "toe", 0, preset, tmp_path / "guided")
    policy = tmp_path / "guided" / "policy.onnx"
    training = begun(preset, policy, tmp_path / "next", task=task)
    columns = list(training.environment.observation_columns["policy"])
    assert not any(name.startswith("clock") for name in columns)
    old = json.loads({e.key: e.value for e in onnx.load(policy).metadata_props}["columns"])
    observation = np.random.default_rng(2).normal(0.0, 1.0, (20, len(columns))).astype(np.float32)
    before = np.zeros((20, len(old)), np.float32)
    for i, name in enumerate(old):
        if name.startswith("command") and task == "t_test_free":
            before[:, i] = float(tiny.warm_start.forward) * (name == "command.0")
        elif not name.startswith("clock"):
            before[:, i] = observation[:, columns.index(name)]
    (expected,) = ort.InferenceSession(policy).run(["action"], {"observation": before})
    np.testing.assert_allclose(
        training.policy(observation), expected, atol=2e-4 * (1 + np.abs(expected).max())
    )
    training.environment.close()


def test_it_begins_by_doing_what_the_walk_did(tiny: Preset, walker: Path, tmp_path: Path) -> None:
    training = begun(tiny, walker, tmp_path)
    columns = list(training.environment.observation_columns["policy"])
    session = ort.InferenceSession(walker)
    old = json.loads({e.key: e.value for e in onnx.load(walker).metadata_props}["columns"])
    observation = np.random.default_rng(0).normal(0.0, 1.0, (20, len(columns))).astype(np.float32)
    before = np.zeros((20, len(old)), np.float32)
    for i, name in enumerate(old):
        before[:, i] = (
            float(tiny.warm_start.forward) * (name == "command.0")
            if name.startswith("command")
            else observation[:, columns.index(name)]
        )
    (expected,) = session.run(["action"], {"observation": before})
    np.testing.assert_allclose(
        training.policy(observation), expected, atol=2e-4 * (1 + np.abs(expected).max())
    )
    training.environment.close()


def test_wider_layers_begin_by_doing_the_same(tiny: Preset, tmp_path: Path) -> None:
    assert train("walk", "toe", 0, tiny, tmp_path / "narrow")
    policy = tmp_path / "narrow" / "policy.onnx"
    network = dataclasses.replace(tiny.network, hidden=(24, 8))
    training = begun(
        dataclasses.replace(tiny, network=network), policy, tmp_path / "wide", task="walk"
    )
    columns = training.environment.observation_columns["policy"]
    observation = np.random.default_rng(1).normal(0.0, 1.0, (20, len(columns)))
    observation = observation.astype(np.float32)
    (expected,) = ort.InferenceSession(policy).run(["action"], {"observation": observation})
    np.testing.assert_allclose(
        training.policy(observation), expected, atol=2e-4 * (1 + np.abs(expected).max())
    )
    first = next(training.algorithm.actor.mlp.parameters())
    assert first.shape[0] == 24
    assert torch.all(first[16:].abs().amax(1) > 0)  # new units can learn
    training.environment.close()


@pytest.mark.parametrize("task", ["walk", "goal"])
def test_from_a_policy_of_the_same_task_it_goes_on_as_it_was(
    tiny: Preset, tmp_path: Path, task: str
) -> None:
    """Commands keep their weights and are followed; nothing is folded into a bias."""
    assert train(task, "toe", 0, tiny, tmp_path / "first")
    policy = tmp_path / "first" / "policy.onnx"
    training = begun(tiny, policy, tmp_path, task=task)
    columns = training.environment.observation_columns["policy"]
    observation = np.random.default_rng(1).normal(0.0, 1.0, (20, len(columns)))
    observation = observation.astype(np.float32)
    (expected,) = ort.InferenceSession(policy).run(["action"], {"observation": observation})
    np.testing.assert_allclose(
        training.policy(observation), expected, atol=2e-4 * (1 + np.abs(expected).max())
    )
    training.environment.close()


def test_a_training_of_the_same_task_goes_on_with_critic_and_noise(
    tiny: Preset, tmp_path: Path
) -> None:
    """What it starts with is what the first training ended with, not the preset's deviation."""
    assert train("goal", "toe", 0, tiny, tmp_path / "first")
    first, policy = tmp_path / "first", tmp_path / "first" / "policy.onnx"
    training = begun(tiny, policy, tmp_path / "next", task="goal")
    ended = begun_from_checkpoint(tiny, first)
    before, after = ended.algorithm, training.algorithm
    observation = {name: values[:4] for name, values in training.observations.items()}
    states = as_tensors({name: values.numpy() for name, values in observation.items()})
    with torch.no_grad():
        np.testing.assert_allclose(after.critic(states), before.critic(states), atol=1e-4)
    np.testing.assert_allclose(
        after.actor.distribution.log_std_param.detach(),
        before.actor.distribution.log_std_param.detach(),
        atol=1e-6,
    )
    assert training._critic_only == 0
    (first / "critic.onnx").unlink()
    without = begun(tiny, policy, tmp_path / "without", task="goal")
    assert without._critic_only == int(WarmStart().critic_iterations)
    assert without.description["start"] != training.description["start"]
    for one in (training, ended, without):
        one.environment.close()


def test_another_tasks_critic_is_left(tiny: Preset, walker: Path, tmp_path: Path) -> None:
    start = read_start(walker)
    assert start.critic is not None
    training = begun(tiny, walker, tmp_path)
    assert training._critic_only == int(WarmStart().critic_iterations)
    training.environment.close()


def test_another_default_posture_is_refused(tiny: Preset, walker: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="posture"):
        begun(tiny, walker, tmp_path, task=load_task("goal").changed(posture_deg={"knee": 10.0}))


def test_the_critic_learns_alone_at_first(tiny: Preset, walker: Path, tmp_path: Path) -> None:
    training = begun(tiny, walker, tmp_path)
    assert training._critic_only == int(WarmStart().critic_iterations)
    before = {k: v.clone() for k, v in training.algorithm.actor.mlp.state_dict().items()}
    critic = {k: v.clone() for k, v in training.algorithm.critic.mlp.state_dict().items()}
    rate = training.algorithm.learning_rate
    training._iterate()
    assert all(
        torch.equal(before[k], v) for k, v in training.algorithm.actor.mlp.state_dict().items()
    )
    assert any(
        not torch.equal(critic[k], v) for k, v in training.algorithm.critic.mlp.state_dict().items()
    )
    assert training.algorithm.learning_rate == rate
    training._critic_only = 0
    training._iterate()
    assert any(
        not torch.equal(before[k], v) for k, v in training.algorithm.actor.mlp.state_dict().items()
    )
    training.environment.close()


def test_a_start_is_told_and_resumes(tiny: Preset, walker: Path, tmp_path: Path) -> None:
    assert not train("goal", "toe", 0, tiny, tmp_path / "a", start=walker, iterations=1)
    assert json.loads((tmp_path / "a" / "run.json").read_text())["start"]["task"] == "walk"
    assert not train("goal", "toe", 0, tiny, tmp_path / "a", start=walker, iterations=1)
    with pytest.raises(InputError, match="start"):
        train("goal", "toe", 0, tiny, tmp_path / "a", iterations=1)


def test_bad_starts(tiny: Preset, walker: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expects a policy for"):
        begun(tiny, walker, tmp_path, design="toe_removed")
    narrow = dataclasses.replace(tiny, network=dataclasses.replace(tiny.network, hidden=(8, 8)))
    with pytest.raises(InputError, match=r"at most \[8, 8"):
        begun(narrow, walker, tmp_path)
    with pytest.raises(InputError, match="would miss it"):
        train("goal_paper", "toe", 0, with_goal_paper(tiny), tmp_path / "b", start=walker)
    with pytest.raises(InputError, match="cannot be read"):
        read_start(tmp_path / "none.onnx")
    (tmp_path / "cut.onnx").write_bytes(walker.read_bytes()[:1000])
    with pytest.raises(InputError, match="truncated"):
        read_start(tmp_path / "cut.onnx")


def with_goal_paper(tiny: Preset) -> Preset:
    return dataclasses.replace(tiny, tasks={**tiny.tasks, "goal_paper": tiny.tasks["goal"]})


CONDITIONED = resources.content_folder("sim") / "conditioned/walk_designs-toe-0/policy.onnx"
HEAVY = ("toe.mass=0.9", "transmission.scale.knee=1.9", "thigh.length=0.42")


def observed(policy: Path, design: RobotDesign, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Random observations without the design, and the same with the numbers of the design."""
    metadata = {entry.key: entry.value for entry in onnx.load(policy).metadata_props}
    ranges = design_ranges(json.loads(metadata["design_ranges"]), "")
    drawn = np.random.default_rng(3).normal(0.0, 1.0, (50, size)).astype(np.float32)
    numbers = np.broadcast_to(ranges.numbers(design), (50, len(ranges.ranges)))
    columns = json.loads(metadata["columns"])
    assert columns[size:] == ranges.columns
    return drawn, np.hstack([drawn, numbers]).astype(np.float32)


def test_a_conditioned_policy_starts_as_it_acts_on_the_design(tmp_path: Path) -> None:
    design, preset = load_design("toe", overrides=HEAVY), load_preset("designs")
    start, task = read_start(CONDITIONED, design), load_task("walk_upright")
    description = {**describe(task, design, 0, preset), "start": start.source}
    training = Training(task, design, 0, preset, tmp_path, 1, description, start)
    assert training._critic_only == 0  # the shipped critic is taken over
    size = len(training.environment.observation_columns["policy"])
    without, with_design = observed(CONDITIONED, design, size)
    (expected,) = ort.InferenceSession(CONDITIONED).run(["action"], {"observation": with_design})
    found = training.policy(without)
    np.testing.assert_allclose(found, expected, atol=2e-4 * (1 + np.abs(expected).max()))
    # and not as it acts on the robot that the ranges were drawn around
    (other,) = ort.InferenceSession(CONDITIONED).run(
        ["action"], {"observation": observed(CONDITIONED, load_design("toe"), size)[1]}
    )
    assert np.abs(found - other).max() > 0.05
    training.environment.close()


def test_the_critic_of_a_conditioned_training_goes_on(tiny: Preset, tmp_path: Path) -> None:
    """The critic, too, judges as it did on the design."""
    spread = DesignSpread(
        ranges=DesignRanges({"toe.mass": Range(0.1, 0.4), "thigh.length": Range(0.34, 0.4)}),
        pool=4,
    )
    assert train("goal", "toe", 0, tiny, tmp_path / "first", designs=spread)
    modulated, design = tmp_path / "first" / "policy.onnx", load_design("toe")
    start = read_start(modulated, design)
    assert start.critic is not None
    task = load_task("goal")
    description = {**describe(task, design, 0, tiny), "start": start.source}
    training = Training(task, design, 0, tiny, tmp_path / "next", 1, description, start)
    assert training._critic_only == 0
    columns = training.environment.observation_columns["critic"]
    numbers = spread.ranges.numbers(design)
    drawn = np.random.default_rng(4).normal(0.0, 1.0, (50, len(columns))).astype(np.float32)
    with_design = np.hstack([drawn, np.tile(numbers, (50, 1))]).astype(np.float32)
    session = ort.InferenceSession(modulated.parent / "critic.onnx")
    (expected,) = session.run(["action"], {"observation": with_design})
    with torch.no_grad():
        found = training.algorithm.critic(as_tensors({"critic": drawn})).numpy()
    np.testing.assert_allclose(found, expected, atol=2e-4 * (1 + np.abs(expected).max()))
    training.environment.close()


def test_a_training_of_many_designs_takes_over_the_critic_of_one(
    tiny: Preset, tmp_path: Path
) -> None:
    """It begins by judging every design as that critic judged its own."""
    assert train("goal", "toe", 0, tiny, tmp_path / "first")
    spread = DesignSpread(ranges=DesignRanges({"toe.mass": Range(0.1, 0.4)}), pool=4)
    start, design = read_start(tmp_path / "first" / "policy.onnx"), load_design("toe")
    task = load_task("goal").conditioned(spread.ranges)
    description = {**describe(task, design, 0, tiny), "start": start.source}
    training = Training(
        task, design, 0, tiny, tmp_path / "many", 1, description, start, None, spread
    )
    assert training._critic_only == 0
    columns = training.environment.observation_columns["critic"]
    assert columns[-1] == "design.toe.mass"
    drawn = np.random.default_rng(5).normal(0.0, 1.0, (50, len(columns))).astype(np.float32)
    session = ort.InferenceSession(tmp_path / "first" / "critic.onnx")
    (expected,) = session.run(["action"], {"observation": drawn[:, :-1]})
    with torch.no_grad():
        found = training.algorithm.critic(as_tensors({"critic": drawn})).numpy()
    np.testing.assert_allclose(found, expected, atol=2e-4 * (1 + np.abs(expected).max()))
    training.environment.close()


def test_a_conditioned_policy_starts_one_design_inside_its_ranges(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"conditioned on its design.*one design only"):
        train("walk_upright", "toe", 0, "designs", tmp_path, start=CONDITIONED, designs="toe")
    with pytest.raises(InputError, match=r"toe\.mass.*1\.5.*expects 0\.05 \.\. 1"):
        train(
            "walk_upright",
            "toe",
            0,
            "designs",
            tmp_path,
            overrides=["toe.mass=1.5"],
            start=CONDITIONED,
        )
    with pytest.raises(InputError, match=r"hip_yaw.gear.*mini_cheetah has no such leaf"):
        read_start(CONDITIONED, load_robot("mini_cheetah"))
    assert not list(tmp_path.iterdir())
