from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.learning.preset import Preset
from hyperleg_design.learning.preset_file import preset_from_mapping
from hyperleg_design.learning.records.status import CHECKPOINT, POLICY
from hyperleg_design.robot.load import load_robot
from hyperleg_design.simulation.tasks import load_task

torch = pytest.importorskip("torch")
onnxruntime = pytest.importorskip("onnxruntime")
pytest.importorskip("rsl_rl")
pytest.importorskip("tensorboard")

from hyperleg_design.learning.train import describe  # noqa: E402
from hyperleg_design.learning.training import Training  # noqa: E402

from .conftest import tiny_mapping  # noqa: E402


def training(preset: Preset, folder: Path) -> Training:
    task, design = load_task("walk"), load_robot("toe")
    description = {
        **describe(task, design, 0, preset),
        **dict.fromkeys(("start", "overlay", "designs")),
        "command": "hyperleg train",
    }
    return Training(task, design, 0, preset, folder, 1, description)


def test_the_exported_network_acts_as_the_policy(tiny: Preset, tmp_path: Path) -> None:
    learner = training(tiny, tmp_path)
    learner.run(2, lambda line: None)
    learner._export(POLICY)
    session = onnxruntime.InferenceSession(str(tmp_path / POLICY))
    (given,) = session.get_inputs()
    observation = np.random.default_rng(0).normal(size=(1, given.shape[1])).astype(np.float32)
    (action,) = session.run(None, {given.name: observation})[:1]
    np.testing.assert_allclose(action, learner.policy(observation), atol=1e-5)


def test_only_an_episode_that_was_cut_goes_on_in_value(tiny: Preset, tmp_path: Path) -> None:
    learner = training(tiny, tmp_path)
    whole = {name: values.numpy() for name, values in learner.observations.items()}
    ended = np.array([0, 1])
    step = SimpleNamespace(
        ended=ended,
        truncated=np.array([True] + [False] * 7),
        final_observations={name: values[ended] for name, values in whole.items()},
    )
    reward = torch.zeros(8)
    with torch.inference_mode():
        learner._bootstrap(step, reward)
        value = learner.algorithm.critic(learner.observations).squeeze(-1)
    discount = tiny.algorithm.discount
    assert float(reward[0]) == pytest.approx(discount * float(value[0]), rel=1e-5)
    assert not torch.any(reward[1:])


def test_a_checkpoint_of_another_network_is_refused(tiny: Preset, tmp_path: Path) -> None:
    training(tiny, tmp_path).save()
    other = preset_from_mapping(tiny_mapping() | {"network": {"hidden": [4]}}, "other.yaml")
    with pytest.raises(InputError, match=f"{CHECKPOINT}.*do not fit"):
        training(other, tmp_path)
