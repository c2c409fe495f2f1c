from __future__ import annotations

import json
import os
import signal
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.learning.preset import Preset
from hyperleg_design.learning.preset_file import preset_from_mapping
from hyperleg_design.learning.records.status import (
    CHECKPOINT,
    POLICY,
    PROGRESS,
    RUN,
    policies,
    read_status,
)
from hyperleg_design.simulation.design_observation import DesignRanges, Range
from hyperleg_design.simulation.design_spread import DesignSpread

torch = pytest.importorskip("torch")
onnxruntime = pytest.importorskip("onnxruntime")
pytest.importorskip("rsl_rl")
pytest.importorskip("tensorboard")

from hyperleg_design.learning import train as module  # noqa: E402
from hyperleg_design.learning import training  # noqa: E402
from hyperleg_design.learning.records.checkpoint import load_checkpoint  # noqa: E402
from hyperleg_design.learning.train import train  # noqa: E402

from .conftest import tiny_mapping  # noqa: E402


@pytest.fixture(autouse=True)
def short_trials(monkeypatch: pytest.MonkeyPatch) -> None:
    from hyperleg_design.learning.records import trial

    monkeypatch.setattr(trial, "WALK", 0.2)
    monkeypatch.setattr(trial, "COURSE", 0.2)


def networks(folder: Path) -> dict[str, np.ndarray]:
    saved = load_checkpoint(folder / CHECKPOINT)["networks"]
    return {
        f"{kind}.{name}": value.numpy()
        for kind in ("actor_state_dict", "critic_state_dict")
        for name, value in saved[kind].items()
    }


def test_resuming_changes_not_a_bit(tiny: Preset, tmp_path: Path) -> None:
    assert train("walk", "toe", 7, tiny, tmp_path / "straight")
    assert not train("walk", "toe", 7, tiny, tmp_path / "parts", iterations=3)
    assert not (tmp_path / "parts" / POLICY).exists()
    torch.manual_seed(123)  # whatever happens between
    assert train("walk", "toe", 7, tiny, tmp_path / "parts")
    straight, parts = networks(tmp_path / "straight"), networks(tmp_path / "parts")
    assert straight.keys() == parts.keys()
    for name, value in straight.items():
        np.testing.assert_array_equal(parts[name], value, err_msg=name)
    assert (tmp_path / "straight" / POLICY).read_bytes() == (
        tmp_path / "parts" / POLICY
    ).read_bytes()
    lines = [
        [json.loads(x) for x in (tmp_path / n / PROGRESS).read_text().splitlines()]
        for n in ("straight", "parts")
    ]
    assert [x["iteration"] for x in lines[1]] == [1, 2, 3, 4, 5, 6]
    for one, other in zip(*lines, strict=True):
        for clock in ("rate", "minutes", "processor_minutes"):
            one.pop(clock), other.pop(clock)
        assert one == other


def test_seeds_differ(tiny: Preset, tmp_path: Path) -> None:
    for seed in (0, 1):
        train("walk", "toe", seed, tiny, tmp_path / str(seed), iterations=1)
    zero, one = networks(tmp_path / "0"), networks(tmp_path / "1")
    assert any(not np.array_equal(zero[name], one[name]) for name in zero)


def test_a_policy_says_what_it_is(tiny: Preset, tmp_path: Path) -> None:
    from hyperleg_design.simulation.tasks import task_from_mapping

    shown: list[str] = []
    folder = tmp_path / "run"
    assert train("goal", "toe_removed_matched", 2, tiny, folder, show=shown.append)
    assert "goal toe_removed_matched seed 2" in shown[-1]
    assert "falls" in shown[-1]
    assert read_status(folder)["done"]
    assert [p.name for p in policies(folder)] == ["late_000001.onnx", POLICY]
    assert any(p.name.startswith("events.") for p in folder.iterdir())
    session = onnxruntime.InferenceSession(str(folder / POLICY))
    said = session.get_modelmeta().custom_metadata_map
    assert (said["variant"], said["seed"], said["steps"]) == ("toe_removed_matched", "2", "96")
    assert len(json.loads(said["joints"])) == 12
    assert session.get_inputs()[0].shape[1] == len(json.loads(said["columns"])) == 57 + 2 + 4
    assert task_from_mapping(json.loads(said["task"]), "onnx").name == "goal"
    assert "goal_speed" in json.loads(said["deviations"])
    assert json.loads(said["design"])["variant"] == "toe_removed_matched"
    assert json.loads(said["preset"])["tasks"].keys() == {"goal"}
    assert (
        said["command"]
        == "hyperleg train --task goal --design toe_removed_matched --seed 2 --preset tiny"
    )
    assert {"commit", "versions"} <= said.keys()


def test_a_finished_training_is_left_alone(tiny: Preset, tmp_path: Path) -> None:
    train("walk", "toe", 0, tiny, tmp_path / "run")
    before = {p.name: p.read_bytes() for p in (tmp_path / "run").iterdir()}
    assert train("walk", "toe", 0, tiny, tmp_path / "run")
    after = {p.name: p.read_bytes() for p in (tmp_path / "run").iterdir()}
    assert after == before


def test_a_signal_stops_with_a_checkpoint(
    tiny: Preset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(training, "SHOW_EVERY", 0.0)
    assert not train(
        "walk",
        "toe",
        0,
        tiny,
        tmp_path / "run",
        show=lambda line: os.kill(os.getpid(), signal.SIGTERM),
    )
    assert load_checkpoint(tmp_path / "run" / CHECKPOINT)["schedule"]["iteration"] == 1
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
    assert train("walk", "toe", 0, tiny, tmp_path / "run")


def test_another_training_is_not_gone_on_with(tiny: Preset, tmp_path: Path) -> None:
    train("walk", "toe", 0, tiny, tmp_path / "run", iterations=1)
    for seed, design, preset, field in (
        (1, "toe", tiny, "seed"),
        (0, "toe_removed", tiny, "variant"),
        (0, "toe", replace(tiny, rollout=5.0), "preset"),
    ):
        with pytest.raises(InputError) as caught:
            train("walk", design, seed, preset, tmp_path / "run")
        assert caught.value.field == field
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("years of work")
    with pytest.raises(OutputError, match="did not write"):
        train("walk", "toe", 0, tiny, tmp_path / "mine")


def test_two_at_once_in_one_folder(tiny: Preset, tmp_path: Path) -> None:
    train("walk", "toe", 0, tiny, tmp_path / "run", iterations=1)
    with module._alone(tmp_path / "run"), pytest.raises(InputError, match="at work"):
        train("walk", "toe", 0, tiny, tmp_path / "run")


def test_a_truncated_checkpoint_is_named_and_a_full_disk_costs_nothing(
    tiny: Preset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "run"
    train("walk", "toe", 0, tiny, folder, iterations=2)
    content = (folder / CHECKPOINT).read_bytes()

    def full(*_: object) -> None:
        raise OutputError("disk full")

    with monkeypatch.context() as patch:
        patch.setattr(training, "save_checkpoint", full)
        with pytest.raises(OutputError):
            train("walk", "toe", 0, tiny, folder)
    assert (folder / CHECKPOINT).read_bytes() == content
    (folder / CHECKPOINT).write_bytes(content[: len(content) // 2])
    with pytest.raises(InputError, match="truncated"):
        train("walk", "toe", 0, tiny, folder)
    (folder / CHECKPOINT).write_bytes(content)
    assert train("walk", "toe", 0, tiny, folder)
    assert json.loads((folder / RUN).read_text())["seed"] == 0


def test_an_overlay_is_trained_with_written_down_and_compared(tiny: Preset, tmp_path: Path) -> None:
    from hyperleg_design.simulation.drives.two_mass import Belt

    loose, overlay = (
        (Belt("left_hip_pitch", compliance=5.0, play=0.5),),
        {"schema": 1, "effects": []},
    )
    assert (
        train(
            "walk",
            "toe",
            7,
            tiny,
            tmp_path / "altered",
            alterations=loose,
            overlay=overlay,
            iterations=2,
        )
        is False
    )
    assert not train("walk", "toe", 7, tiny, tmp_path / "plain", iterations=2)
    altered, plain = networks(tmp_path / "altered"), networks(tmp_path / "plain")
    assert any(not np.array_equal(altered[name], plain[name]) for name in plain)
    assert json.loads((tmp_path / "altered" / RUN).read_text())["overlay"] == overlay
    assert json.loads((tmp_path / "plain" / RUN).read_text())["overlay"] is None
    with pytest.raises(InputError, match="overlay"):
        train("walk", "toe", 7, tiny, tmp_path / "altered", iterations=1)
    assert train("walk", "toe", 7, tiny, tmp_path / "altered", alterations=loose, overlay=overlay)
    straight = tmp_path / "straight"
    assert train("walk", "toe", 7, tiny, straight, alterations=loose, overlay=overlay)
    for name, value in networks(straight).items():
        np.testing.assert_array_equal(networks(tmp_path / "altered")[name], value, err_msg=name)
    session = onnxruntime.InferenceSession(
        (straight / POLICY).read_bytes(), providers=["CPUExecutionProvider"]
    )
    assert json.loads(session.get_modelmeta().custom_metadata_map["overlay"]) == overlay


def test_the_actions_deviation_keeps_to_its_bound(tmp_path: Path) -> None:
    data = tiny_mapping()
    ramp = {"set": "policy.deviation", "from": 0.3, "to": 0.1, "steps": 96}
    data["tasks"]["walk"][0]["ramps"] = [ramp]
    train("walk", "toe", 0, preset_from_mapping(data, "p.yaml"), tmp_path, iterations=4)
    rows = [json.loads(line) for line in (tmp_path / PROGRESS).read_text().splitlines()]
    bounds = [0.3, 0.3 - 0.2 / 3, 0.3 - 0.4 / 3, 0.1]
    for row, bound in zip(rows, bounds, strict=True):
        assert row["deviation"] <= 1.01 * bound  # one update may raise it by its learning rate


def test_a_quadruped_trains_and_its_policy_is_evaluated(tiny: Preset, tmp_path: Path) -> None:
    from hyperleg_design.evaluation.evaluate import evaluate
    from hyperleg_design.evaluation.protocol import Steady, WalkProtocol

    data = tiny_mapping()
    data["tasks"] = {"walk_any": [{"name": "all", "steps": 32, "assist": 0.0}]}
    preset = preset_from_mapping(data, "tiny.yaml")
    assert train("walk_any", "mini_cheetah", 0, preset, tmp_path / "run")
    protocol = WalkProtocol(trials=2, distance=0.5, time_limit=1.0, steady=Steady(begin=0.1))
    found = evaluate(tmp_path / "run" / POLICY, protocol, threads=1)
    assert found.design == "mini_cheetah"
    assert found.trained.kind == "specialist"
    assert len(found.trials) == 2
    with pytest.raises(InputError, match=r"hip_deviation.*lacks joints hip_yaw"):
        train("walk", "mini_cheetah", 0, tiny, tmp_path / "other")
    assert not (tmp_path / "other").exists()


SPREAD = DesignSpread(
    ranges=DesignRanges(
        {
            "toe.mass": Range(0.05, 1.0, log=True),
            "transmission.scale.knee": Range(0.8, 1.25, log=True),
        }
    ),
    pool=4,
    redraw_every=2,
)


@pytest.mark.slow
def test_a_conditioned_training_resumes_bit_for_bit(tiny: Preset, tmp_path: Path) -> None:
    assert train("walk", "toe", 7, tiny, tmp_path / "straight", designs=SPREAD)
    assert not train("walk", "toe", 7, tiny, tmp_path / "parts", designs=SPREAD, iterations=3)
    assert train("walk", "toe", 7, tiny, tmp_path / "parts", designs=SPREAD)
    straight, parts = networks(tmp_path / "straight"), networks(tmp_path / "parts")
    for name, value in straight.items():
        np.testing.assert_array_equal(parts[name], value, err_msg=name)
    assert (tmp_path / "straight" / POLICY).read_bytes() == (
        tmp_path / "parts" / POLICY
    ).read_bytes()
    with pytest.raises(InputError, match="another training"):
        train("walk", "toe", 7, tiny, tmp_path / "parts")


def test_a_conditioned_policy_knows_its_ranges(tiny: Preset, tmp_path: Path) -> None:
    from hyperleg_design.evaluation.policy import check_layout, load_policy
    from hyperleg_design.evaluation.training_fit import training_fit
    from hyperleg_design.robot.design import load_design
    from hyperleg_design.simulation.environment import Environment

    train("walk", "toe", 0, tiny, tmp_path / "run", designs=SPREAD)
    policy = load_policy(tmp_path / "run" / POLICY)
    assert policy.columns[-2:] == ("design.toe.mass", "design.transmission.scale.knee")
    design = load_design("toe")
    assert training_fit(policy, design.with_values({"toe.mass": 0.9})).kind == "conditioned"
    assert training_fit(policy, design.with_values({"toe.mass": 1.1})).outside == ("toe.mass",)
    heavy = design.with_values({"toe.mass": np.array([0.05, 1.0])})
    environment = Environment(heavy, policy.task, simulations=4)
    check_layout(policy, environment)
    observation = environment.reset()["policy"]
    np.testing.assert_allclose(observation[:, -2], [-1, -1, 1, 1], atol=1e-6)
    np.testing.assert_allclose(observation[:, -1], 0, atol=1e-6)
    stepped = environment.step(policy(observation)).observations["policy"]
    np.testing.assert_array_equal(stepped[:, -2:], observation[:, -2:])
