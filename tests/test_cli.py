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
        (["check", "no/such/file.urdf"], ["no/such/file.urdf"]),
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
<<<<<<< HEAD
=======


def test_campaign_speaks_json(capsys, tmp_path: Path):
    code, out, _ = run(capsys, "campaign", "status", "--out", str(tmp_path / "none"), "--json")
    assert code == 0
    found = json.loads(out)
    assert len(found) == 64
    assert {row["state"] for row in found} <= {"missing", "shipped"}


def test_missing_trainings_are_named(tmp_path: Path):
    from hyperleg_design.report.walks.evaluated import coverage, coverage_text

    (tmp_path / "walk_upright-toe-0").mkdir()
    (tmp_path / "walk_upright-toe-0" / "policy.onnx").write_bytes(b"x")
    found = coverage(tmp_path)
    assert found["evaluated"] == ["walk_upright-toe-0"]
    assert len(found["missing"]) == 31 + 20  # four arms, seeds of walks and T-tests
    text = coverage_text(found)
    assert text.startswith("1 trainings are evaluated; of those that the study plans, 51 are miss")
    assert "walk_upright-toe-1..7" in text
    assert "t_test_free-toe_locked-0..4" in text


def test_gap_alone_shows_its_verbs(capsys):
    code, out, _ = run(capsys, "gap")
    assert code == 0
    assert "effects" in out
    assert "apply" in out
    code, _, err = run(capsys, "gap", "shwo")
    assert code == 2
    assert len(err.strip().splitlines()) == 1


def test_validate_lists_its_cases_and_skips_those_whose_logs_are_absent(capsys, tmp_path: Path):
    code, out, _ = run(capsys, "validate", "--list-cases", "--suites", "blind", "newcomers")
    assert code == 0
    assert "blind-000" in out
    assert "new-two_link" in out
    code, out, _ = run(
        capsys, "validate", "--only", "go2", "--data", str(tmp_path), "--out", str(tmp_path / "o")
    )
    assert code == 0
    assert "Skipped: 4 cases of go2_air" in out
    code, _, error = run(capsys, "validate", "--only", "nothing_like_it")
    assert code == 2
    assert "fits no case" in error
>>>>>>> adefaa7 (Show every arm of the T-test on the study's pages, and name its missing trainings)
