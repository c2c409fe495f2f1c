"""Verbs on policies: campaigns, and what is missing."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hyperleg_design import cli
from hyperleg_design.evaluation.shipped import find_policy


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = cli.main(list(arguments))
    out, err = capsys.readouterr()
    return code, out, err


def test_campaign_status_needs_no_torch_and_lists_every_training(capsys, tmp_path: Path):
    code, out, _ = run(capsys, "campaign", "status", "--out", str(tmp_path / "none"))
    assert code == 0
    done = out.count(" shipped ") + out.count(" unneeded ")
    assert 0 < out.count(" unneeded ") < done
    assert out.count(" missing ") == 64 - done
    assert f"{done} of 64 done" in out


def test_training_without_torch_says_what_to_install(capsys, tmp_path: Path, monkeypatch):
    import importlib.util

    real = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util,
        "find_spec",
        lambda name, *rest: None if name == "torch" else real(name, *rest),
    )
    code, _, err = run(capsys, "train", "--out", str(tmp_path / "t"))
    assert code == 2
    assert "torch" in err
    assert "learning" in err


def test_a_campaign_is_packed_for_shipping(capsys, tmp_path: Path):
    folder = tmp_path / "campaign" / "walk_upright-toe-0"
    folder.mkdir(parents=True)
    (folder / "policy.onnx").write_bytes(find_policy("walk_upright-toe-0").read_bytes())
    (tmp_path / "campaign" / "walk_upright-toe-1").mkdir()
    code, out, _ = run(
        capsys,
        "campaign",
        "pack",
        "--from",
        str(tmp_path / "campaign"),
        "--to",
        str(tmp_path / "policies"),
    )
    assert code == 0
    assert "1 of 2 trainings, 1 policies, 0.1 MB" in out
    assert (tmp_path / "policies" / "walk_upright-toe-0" / "policy.onnx").exists()
    code, _, err = run(
        capsys, "campaign", "pack", "--from", str(tmp_path / "none"), "--to", str(tmp_path / "p")
    )
    assert code == 2
    assert "no such folder" in err


def test_campaign_speaks_json(capsys, tmp_path: Path):
    code, out, _ = run(capsys, "campaign", "status", "--out", str(tmp_path / "none"), "--json")
    assert code == 0
    found = json.loads(out)
    assert len(found) == 64
    assert {row["state"] for row in found} <= {"missing", "shipped", "unneeded"}


def test_missing_trainings_are_named(tmp_path: Path):
    from hyperleg_design.report.walks.compared import coverage, coverage_text

    (tmp_path / "walk_upright-toe-0").mkdir()
    (tmp_path / "walk_upright-toe-0" / "policy.onnx").write_bytes(b"x")
    found = coverage(tmp_path)
    assert found["evaluated"] == ["walk_upright-toe-0"]
    assert len(found["missing"]) == 31 + 20  # four arms, seeds of walks and T-tests
    text = coverage_text(found)
    assert text.startswith("1 trainings are evaluated; of those that the study plans, 51 are miss")
    assert "walk_upright-toe-1..7" in text
    assert "t_test_free-toe_locked-0..4" in text


def test_a_training_starts_from_a_shipped_one_by_name(capsys, tmp_path: Path, monkeypatch):
    """The training gets the path of the policy; a misspelt name is refused before it begins."""
    from hyperleg_design.learning import launch

    commands = []

    def replace_this_process(arguments, threads):
        commands.append(arguments)
        raise SystemExit(0)

    monkeypatch.setattr("hyperleg_design.cli.policies.require", lambda *names: None)
    monkeypatch.setattr(launch, "run_here", replace_this_process)
    folder = str(tmp_path / "training")
    heavy = ("--set", "toe.mass=0.5", "--set", "thigh.length=0.4")
    assert run(capsys, "train", "--start", "walk_upright-toe-1", *heavy, "--out", folder)[0] == 0
    assert f"--start={find_policy('walk_upright-toe-1')}" in commands[0]
    assert {"--set=toe.mass=0.5", "--set=thigh.length=0.4"} < set(commands[0])
    code, _, error = run(capsys, "train", "--set", "toe.mas=0.5", "--out", folder)
    assert code == 2
    assert "toe.mas" in error
    code, _, error = run(capsys, "train", "--start", "walk_upright-toe-9", "--out", folder)
    assert code == 2
    assert "--start = 'walk_upright-toe-9': no such file; did you mean walk_upright-toe-" in error
    assert len(commands) == 1


def test_a_robot_that_does_not_fit_the_task_is_told_before_the_process_is_replaced(
    capsys, tmp_path: Path, monkeypatch
):
    from hyperleg_design.learning import launch

    monkeypatch.setattr("hyperleg_design.cli.policies.require", lambda *names: None)
    monkeypatch.setattr(launch, "run_here", lambda *given: pytest.fail("began"))
    for design, task, words in (
        ("mini_cheetah", "walk", "mini_cheetah lacks joints"),
        ("teaching_leg", "walk_any", "trunk.motion = 'fixed'"),
    ):
        arguments = ("train", "--design", design, "--task", task, "--out", str(tmp_path / "new"))
        code, _, error = run(capsys, *arguments)
        assert code == 2
        assert words in error
        assert not (tmp_path / "new").exists()


def test_a_robot_that_cannot_stand_is_refused_before_anything_is_written(capsys, tmp_path: Path):
    pytest.importorskip("rsl_rl")
    robot = ("--design", "mini_cheetah", "--set", "links.trunk.com=[0.6, 0, 0]")
    task = ("--task", "walk_any", "--preset", "walker", "--out", str(tmp_path / "new"))
    code, out, error = run(capsys, "train", *robot, *task)
    assert (code, out) == (2, "")
    assert "mini_cheetah: default posture = [0.244, 0.0]" in error
    assert not list(tmp_path.iterdir())
