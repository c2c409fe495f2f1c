"""The command line: what it prints, its exit codes, and one clear line on bad input."""

from __future__ import annotations

import dataclasses

import pytest

import hyperleg_design
from hyperleg_design import cli


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = cli.main(list(arguments))
    out, err = capsys.readouterr()
    return code, out, err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["analyze", "--set", "toe.mas=0.3"], ["toe.mas", "toe.mass"]),
        (["analyze", "--set", "toe.mass"], ["toe.mass", "path=value"]),
        (["analyze", "--set", "toe.mass=300"], ["toe.mass", "300", "kg"]),
        (["analyze", "--design", "hyperlegs"], ["hyperlegs", "hyperleg"]),
        (["analyze", "--variant", "no_toe"], ["no_toe", "toe_removed"]),
        (["analyze", "--desing", "hyperleg"], ["--desing"]),
        (["analyse"], ["analyse", "analyze"]),
        (["list", "robots"], ["robots", "designs"]),
        (["build"], ["--out"]),
        (["sweep", "walk", "toe_mass", "--out", "x"], ["walk", "run"]),
        (["evaluate", "no/such/policy.onnx", "--out", "x"], ["no/such/policy.onnx"]),
        (["campaign", "start"], ["start", "status"]),
        (["campaign", "status", "no-campaign"], ["no-campaign", "campaign"]),
        (["train", "--seed", "-1", "--out", "x"], ["--seed", "-1", "at least 0"]),
        (
            ["gap", "blind", "--cases", "2", "--seed", "-1", "--out", "x"],
            ["--seed", "-1", "at least 0"],
        ),
    ],
)
def test_bad_input_is_one_clear_line_and_exit_code_two(capsys, arguments, words):
    code, out, err = run(capsys, *arguments)
    assert code == 2
    assert len((err + out).strip().splitlines()) == 1
    for word in words:
        assert word in err + out


def test_every_verb_has_help(capsys):
    for verb, command in cli.VERBS.items():
        code, out, _ = run(capsys, verb, "--help")
        assert code == 0
        assert command.__doc__.split(".")[0][:30] in out


def test_the_version_is_an_option_too(capsys):
    code, out, _ = run(capsys, "--version")
    assert code == 0
    assert out == f"hyperleg {hyperleg_design.__version__}\n"


def test_every_verb_but_training_prints_json_on_request():
    for verb, command in {**cli.VERBS, **cli.gap.VERBS}.items():
        if verb not in ("train", "gap"):
            assert "json" in {field.name for field in dataclasses.fields(command)}, verb


def test_completion_knows_every_verb(capsys):
    code, out, _ = run(capsys, "--tyro-print-completion", "bash")
    assert code == 0
    for verb in (*cli.VERBS, *cli.gap.VERBS):
        assert verb in out
