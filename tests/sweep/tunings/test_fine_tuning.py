from __future__ import annotations

import dataclasses
import json
import subprocess
import sys
import time

import pytest
import yaml

from hyperleg_design import processes, resources
from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.training_fit import training_fit
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.parameters.values import leaves
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import load_task
from hyperleg_design.sweep.tunings import fine_tuning
from hyperleg_design.sweep.tunings.fine_tuning import (
    FineTuning,
    check_trainable,
    fine_tune,
    fine_tuning_preset,
)

pytest.importorskip("torch")
pytest.importorskip("rsl_rl")

from hyperleg_design.evaluation.shipped import find_policy
from hyperleg_design.learning.preset_file import load_preset, preset_from_mapping
from hyperleg_design.learning.schedule import Schedule
from hyperleg_design.learning.train import train


def job(folder, policy="walk_upright-toe-1", steps=100):
    design = load_design("toe", overrides={"toe.mass": 0.31})
    return FineTuning(find_policy(policy), design, steps, folder / "7")


@pytest.mark.parametrize("name", ["walk_upright-toe-1", "t_test_free-toe-0", "walk_guided-toe-1"])
def test_it_trains_under_the_settings_that_the_training_ended_with(name):
    """The only stage sets what the schedule of the whole training sets in its last iteration."""
    policy = load_policy(name)
    whole = preset_from_mapping(policy.metadata["preset"], name)
    tuning = preset_from_mapping(fine_tuning_preset(policy, 100_000), "tuning")
    reached = []
    for preset in (whole, tuning):
        schedule = Schedule(preset, policy.task.name)
        schedule.iteration = schedule.total - 1 if preset is whole else 0
        schedule.gone = [0] * len(preset.stages(policy.task.name))
        schedule.gain = 0.0
        environment = Environment(policy.design, policy.task, simulations=1, seed=0)
        schedule.apply(environment)
        task = environment.task
        reached.append(
            (
                {name: (r.weight, dict(r.parameters)) for name, r in task.rewards.items()},
                leaves(task.commands),
                environment.assist,
            )
        )
        environment.close()
    assert reached[0] == reached[1]
    assert tuning.algorithm == whole.algorithm or leaves(tuning.algorithm) == leaves(
        whole.algorithm
    )
    assert tuning.network.hidden == whole.network.hidden
    assert tuning.total_iterations(policy.task.name) == round(100_000 / whole.steps_per_iteration)
    assert tuning.warm_start.critic_iterations <= 0.2 * 100_000 / whole.steps_per_iteration


def tiny():
    """A preset of few and small steps."""
    base = load_preset("designs")
    stages = tuple(dataclasses.replace(s, steps=64) for s in base.stages("walk_upright"))
    network = dataclasses.replace(base.network, hidden=(16, 8))
    return dataclasses.replace(
        base, simulations=8, rollout=4, network=network, tasks={"walk_upright": stages}
    )


@pytest.fixture(scope="module")
def policy(tmp_path_factory):
    """A policy after 64 steps."""
    folder = tmp_path_factory.mktemp("trained") / "walk_upright-toe-1"
    assert train("walk_upright", "toe", 0, tiny(), folder)
    return folder / "policy.onnx"


@pytest.mark.slow
def test_a_stopped_training_goes_on_and_gives_a_specialist(policy, tmp_path):
    tuning = FineTuning(
        policy, load_design("toe", overrides={"toe.mass": 0.31}), 192, tmp_path / "7"
    )
    fine_tuning._write_inputs(tuning)
    paths = [tuning.folder / f"{tuning.name}.{kind}.yaml" for kind in ("task", "preset")]
    stopped = train(
        paths[0],
        tuning.folder / "design.yaml",
        0,
        paths[1],
        tuning.folder / tuning.name,
        start=policy,
        iterations=4,
    )
    assert not stopped
    assert tuning.steps_done() == 4 * 32
    fine_tune([tuning], workers=1, progress=False)
    assert tuning.steps_done() == 192
    lines = (tuning.folder / tuning.name / "progress.jsonl").read_text().splitlines()
    assert [json.loads(line)["iteration"] for line in lines] == [1, 2, 3, 4, 5, 6]
    tuned = load_policy(tuning.result)
    assert int(tuned.metadata["start"]["steps"]) == load_policy(policy).steps
    assert training_fit(tuned, tuning.design).kind == "specialist"
    before = tuning.result.read_bytes()
    fine_tune([tuning], workers=1, progress=False)
    assert tuning.result.read_bytes() == before


def test_a_folder_holds_the_finalist_of_one_search(tmp_path):
    fine_tuning._write_inputs(job(tmp_path))
    fine_tuning._write_inputs(job(tmp_path))
    other = load_design("toe", overrides={"toe.mass": 0.32})
    with pytest.raises(OutputError, match="another design"):
        fine_tuning._write_inputs(dataclasses.replace(job(tmp_path), design=other))
    again = yaml.safe_load((tmp_path / "7" / "design.yaml").read_text())
    assert again["toe"]["mass"]["value"] == 0.31


def test_a_quadruped_trains_on_from_its_own_policy(tmp_path):
    """What is written is the robot, the task and one stage of it."""
    design = load_robot("mini_cheetah", overrides={"actuators.knee.gear": 8})
    tuning = FineTuning(find_policy("walk_any-mini_cheetah-0"), design, 64_000, tmp_path / "7")
    fine_tuning._write_inputs(tuning)
    written = load_robot(tuning.folder / "design.yaml")
    assert written.to_mapping() == design.to_mapping()
    preset = load_preset(tuning.folder / f"{tuning.name}.preset.yaml")
    task = load_task(tuning.folder / f"{tuning.name}.task.yaml")
    (stage,) = preset.stages(task.name)
    assert (stage.steps, stage.assist) == (64_000, 0.0)


def test_one_training_that_fails_does_not_stop_the_others(tmp_path, monkeypatch):
    script = """
import sys, pathlib
name, out = sys.argv[1:]
if "t_test" in name:
    sys.exit("hyperleg: the disk is full")
out = pathlib.Path(out)
out.parent.mkdir(parents=True)
out.write_text("policy")
"""

    def started(training):
        with training.log.open("ab") as log:
            words = [sys.executable, "-c", script, training.name, str(training.result)]
            return subprocess.Popen(words, stderr=log)

    monkeypatch.setattr(fine_tuning, "_started", started)
    jobs = [job(tmp_path, "t_test_free-toe-0"), job(tmp_path), job(tmp_path, "walk_upright-toe-0")]
    with pytest.raises(InputError, match=r"7/t_test_free-toe-0-100.*the disk is full.*its log is"):
        fine_tune(jobs, workers=1, progress=False)
    assert [t.result.is_file() for t in jobs] == [False, True, True]


def test_an_interrupt_lets_trainings_write_their_checkpoints(tmp_path, monkeypatch):
    script = """
import pathlib, signal, sys, time
out = pathlib.Path(sys.argv[1])
def stop(*_):
    out.with_suffix(".stopped").write_text("")
    sys.exit(3)
signal.signal(signal.SIGTERM, stop)
out.with_suffix(".ready").write_text("")
time.sleep(60)
"""

    def started(training):
        return subprocess.Popen([sys.executable, "-c", script, str(training.folder / "run.x")])

    def sleep(_):
        while not (tmp_path / "7" / "run.ready").exists():
            waited(0.01)
        raise KeyboardInterrupt

    waited = time.sleep
    monkeypatch.setattr(fine_tuning, "_started", started)
    monkeypatch.setattr(processes.time, "sleep", sleep)
    with pytest.raises(KeyboardInterrupt):
        fine_tune([job(tmp_path)], workers=1, progress=False)
    assert (tmp_path / "7" / "run.stopped").exists()


def test_what_cannot_be_a_start_is_one_clear_error(tmp_path, monkeypatch):
    conditioned = str(
        resources.content_folder("sim") / "conditioned/walk_designs-toe-0/policy.onnx"
    )
    outside = load_design("toe", overrides={"toe.mass": 1.5})
    with pytest.raises(InputError, match=r"toe\.mass.*expects 0\.05 \.\. 1"):
        fine_tuning._write_inputs(FineTuning(find_policy(conditioned), outside, 100, tmp_path))
    assert not list(tmp_path.iterdir())
    monkeypatch.setattr(fine_tuning, "NEEDS", ("torch", "no_such_module"))
    with pytest.raises(InputError, match=r"needs no_such_module.*learning"):
        check_trainable(find_policy("walk_upright-toe-1"))
