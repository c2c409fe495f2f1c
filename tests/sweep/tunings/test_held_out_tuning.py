from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import yaml

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.evaluation.held_out import held_out_designs
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.training_fit import training_fit
from hyperleg_design.robot.load import load_robot
from hyperleg_design.sweep.tunings import fine_tuning
from hyperleg_design.sweep.tunings.held_out_tuning import fine_tune_held_out, write_held_out

pytest.importorskip("torch")
pytest.importorskip("rsl_rl")

from hyperleg_design.learning.preset_file import load_preset
from hyperleg_design.learning.train import train


def spread(folder, high):
    path = folder / f"toes_{high}.yaml"
    content = {
        "ranges": {
            "toe.mass": {"low": 0.1, "high": high},
            "foot.ball_length": {"low": 0.1, "high": 0.14},
        },
        "pool": 4,
        "held_out": 2,
    }
    path.write_text(yaml.safe_dump(content))
    return path


@pytest.fixture(scope="module")
def conditioned(tmp_path_factory):
    """A policy for many designs after 64 steps, and its designs."""
    folder = tmp_path_factory.mktemp("trained")
    base, designs = load_preset("designs"), spread(folder, 0.4)
    stages = base.stages("walk_upright")
    stages = tuple(dataclasses.replace(s, steps=64 // len(stages)) for s in stages)
    network = dataclasses.replace(base.network, hidden=(16, 8))
    preset = dataclasses.replace(
        base, simulations=8, rollout=4, network=network, tasks={"walk_upright": stages}
    )
    assert train("walk_upright", "toe", 0, preset, folder / "many", designs=designs)
    return folder / "many" / "policy.onnx", designs


def test_the_files_hold_the_held_out_designs(conditioned, tmp_path):
    policy, designs = conditioned
    robots = held_out_designs([policy], designs).robots
    write_held_out(robots, tmp_path)
    for i, robot in enumerate(robots):
        written = load_robot(tmp_path / str(i) / "design.yaml")
        for leaf in ("toe.mass", "foot.ball_length", "thigh.length"):
            np.testing.assert_array_equal(written[leaf], robot[leaf])
    write_held_out(robots, tmp_path)
    with pytest.raises(OutputError, match=r"0/design\.yaml: is of another design"):
        write_held_out(robots[::-1], tmp_path)


@pytest.mark.slow
def test_every_held_out_design_gets_a_specialist_of_its_own(conditioned, tmp_path):
    policy, designs = conditioned
    robots = held_out_designs([policy], designs).robots
    write_held_out(robots, tmp_path)
    pattern = fine_tune_held_out(policy, robots, 64, tmp_path, workers=1, progress=False)
    for i, robot in enumerate(robots):
        tuned = load_policy(pattern.replace("{}", str(i)))
        assert training_fit(tuned, robot).kind == "specialist"
        assert training_fit(tuned, robots[1 - i]).kind == "zero-shot"
        assert tuned.metadata["start"]["steps"] == "64"


def test_a_design_outside_the_ranges_is_refused_before_any_training(
    conditioned, tmp_path, monkeypatch
):
    policy, _ = conditioned
    robots = held_out_designs([policy], spread(tmp_path, 0.9)).robots
    assert max(float(robot["toe.mass"]) for robot in robots) > 0.4
    monkeypatch.setattr(fine_tuning, "_started", lambda training: pytest.fail("began"))
    with pytest.raises(InputError, match=r"toe\.mass.*expects 0\.1 \.\. 0\.4"):
        fine_tune_held_out(policy, robots, 64, tmp_path / "out", workers=1, progress=False)
