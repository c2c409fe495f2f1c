"""The command line: what it prints, its exit codes, and one clear line on bad input."""

from __future__ import annotations

import dataclasses
import json
import re
from pathlib import Path

import pytest

import hyperleg_design
from hyperleg_design import cli
from hyperleg_design.cli.usage import option_names
from hyperleg_design.evaluation.shipped import find_policy


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = cli.main(list(arguments))
    out, err = capsys.readouterr()
    return code, out, err


def test_analyze_prints_one_json_object(capsys):
    code, out, _ = run(capsys, "analyze", "--design", "hyperleg", "--json")
    found = json.loads(out)
    assert code == 0
    assert found["total_mass"] == pytest.approx(32.0, abs=1e-12)
    assert found["leg_mass"] == pytest.approx(8.27, abs=1e-12)
    assert found["leg_length"] == pytest.approx(0.786, abs=1e-12)
    assert found["height"] == pytest.approx(0.9586, abs=1e-12)
    assert found["max_joint_torque"]["knee"] == pytest.approx(212.0, rel=1e-3)
    assert found["single_joint_speed"]["knee"] == pytest.approx(10.5, abs=0.05)
    assert len(found["reduction"]["walking"]) == len(found["reflected_inertia"]) == 7
    assert found["zonotope_to_box_volume"] == pytest.approx(0.130, abs=5e-4)
    assert found["ablation_confound"]["toe_removed"]["max_joint_torque"][
        "ankle_pitch"
    ] == pytest.approx(76.3, abs=0.05)


@pytest.mark.parametrize("variant", ["toe", "toe_locked", "toe_removed_matched", "toe_removed"])
def test_analyze_takes_every_variant(capsys, variant):
    code, out, _ = run(capsys, "analyze", "--variant", variant, "--json")
    found = json.loads(out)
    assert code == 0
    assert found["variant"] == variant
    assert len(found["joints"]) == (7 if variant == "toe" else 6)


def test_set_is_repeatable_and_reaches_the_design(capsys):
    _, out, _ = run(
        capsys, "analyze", "--set", "toe.mass=0.3", "--set", "pelvis.mass=16.46", "--json"
    )
    assert json.loads(out)["total_mass"] == pytest.approx(33.16, abs=1e-12)


def test_a_file_of_parameters_is_applied_before_set(capsys, tmp_path: Path):
    overlay = tmp_path / "heavy.yaml"
    overlay.write_text(
        "toe: {mass: 0.5}\npelvis: {mass: {value: 10, label: assumed, source: test}}\n"
    )
    _, out, _ = run(
        capsys, "analyze", "--set-file", str(overlay), "--set", "toe.mass=0.3", "--json"
    )
    assert json.loads(out)["total_mass"] == pytest.approx(10 + 2 * (8.27 + 0.08), abs=1e-12)


def test_texts_for_people(capsys):
    for arguments, word in (
        (("analyze",), "13.0 %"),
        (("list",), "RI70"),
        (("list", "parameters"), "toe.mass"),
        (("version",), "mujoco"),
    ):
        code, out, _ = run(capsys, *arguments)
        assert code == 0
        assert word in out


def test_list_speaks_json(capsys):
    _, out, _ = run(capsys, "list", "motors", "--json")
    motors = json.loads(out)["motors"]
    assert len(motors) >= 11
    assert motors["RI70"]["power_constant"] == pytest.approx(24.7, abs=0.05)


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


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["list", "--foo"], "--foo: hyperleg list has no such option; see hyperleg list --help"),
        (
            ["analyze", "--desing", "toe"],
            "--desing: hyperleg analyze has no such option; did you mean --design? "
            "see hyperleg analyze --help",
        ),
        # --threads is an option of other verbs, and no suggestion here
        (
            ["analyze", "--threads", "2"],
            "--threads: hyperleg analyze has no such option; see hyperleg analyze --help",
        ),
        (
            ["gap", "diagnose", "--rboot=x"],
            "--rboot: hyperleg gap diagnose has no such option; did you mean --robot? "
            "see hyperleg gap diagnose --help",
        ),
        (
            ["gap", "diagnos"],
            "verb = 'diagnos': there is none of this name; did you mean diagnose? "
            "see hyperleg gap --help",
        ),
        (["--foo"], "--foo: hyperleg has no such option; see hyperleg --help"),
        (
            ["analyze", "toe"],
            "value = 'toe': expects an option before it, as in --design toe; "
            "see hyperleg analyze --help",
        ),
        (
            ["analyze", "--variant"],
            "Missing value for argument '--variant'. Expected 1 values; "
            "see hyperleg analyze --help",
        ),
    ],
)
def test_what_cannot_be_parsed_is_said_in_short(capsys, arguments, message):
    code, _, err = run(capsys, *arguments)
    assert code == 2
    assert err == f"hyperleg: arguments: {message}\n"


def test_all_options_of_every_verb_are_known_to_the_error(capsys):
    gap = {f"gap {name}": command for name, command in cli.gap.VERBS.items()}
    for verb, command in {**cli.VERBS, **gap}.items():
        if verb == "gap":
            continue
        _, out, _ = run(capsys, *verb.split(), "--help")
        printed = set(re.findall(r"^[│ ]{1,3}(?:-h, )?(--[a-z][a-z-]*)", out, flags=re.MULTILINE))
        assert printed <= set(option_names(command)), verb
        assert "--help" in printed


def test_every_verb_has_help(capsys):
    for verb, command in cli.VERBS.items():
        code, out, _ = run(capsys, verb, "--help")
        assert code == 0
        assert command.__doc__.split(".")[0][:30] in out


def test_build_writes_a_robot_that_other_tools_load(capsys, tmp_path: Path):
    import mujoco
    import pinocchio

    code, out, _ = run(
        capsys, "build", "--set", "toe.mass=0.3", "--out", str(tmp_path / "robot"), "--json"
    )
    files = json.loads(out)["files"]
    assert code == 0
    urdf = next(f for f in files if f.endswith(".urdf"))
    mjcf = next(f for f in files if f.endswith(".xml"))
    assert pinocchio.computeTotalMass(
        pinocchio.buildModelFromUrdf(str(tmp_path / "robot" / urdf))
    ) == pytest.approx(32.16 - 15.46, abs=1e-9)
    assert mujoco.MjModel.from_xml_path(
        str(tmp_path / "robot" / mjcf)
    ).body_mass.sum() == pytest.approx(32.16, abs=1e-9)


def test_build_leaves_a_foreign_folder_alone(capsys, tmp_path: Path):
    (tmp_path / "thesis.txt").write_text("mine")
    code, _, err = run(capsys, "build", "--out", str(tmp_path))
    assert code == 2
    assert str(tmp_path) in err
    assert [p.name for p in tmp_path.iterdir()] == ["thesis.txt"]


def test_campaign_status_needs_no_torch_and_lists_every_training(capsys, tmp_path: Path):
    code, out, _ = run(capsys, "campaign", "status", "--out", str(tmp_path / "none"))
    assert code == 0
    shipped = out.count(" shipped ")
    assert out.count(" missing ") == 64 - shipped
    assert f"{shipped} of 64 done" in out


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


def test_gap_lists_its_effects(capsys):
    code, out, _ = run(capsys, "gap", "effects", "--json")
    found = {row["effect"]: row for row in json.loads(out)}
    assert code == 0
    assert len(found) >= 24
    assert found["backlash"]["where"] == "motor"
    assert run(capsys, "gap", "effects")[1].startswith("actuator_bandwidth")


def test_gap_show_draws_a_figure(capsys, tmp_path):
    code, out, _ = run(
        capsys,
        "gap",
        "show",
        "viscous_friction",
        "--set",
        "damping=0.5",
        "--out",
        str(tmp_path),
        "--json",
    )
    found = json.loads(out)
    assert code == 0
    assert found["parameters"]["damping"]["value"] == 0.5
    assert Path(found["figure"]).read_bytes().startswith(b"\x89PNG")
    code, _, err = run(capsys, "gap", "show", "viscuous_friction", "--out", str(tmp_path))
    assert code == 2
    assert err.strip().endswith("did you mean viscous_friction?")


def test_gap_apply_writes_what_training_and_evaluation_read(capsys, tmp_path):
    cause = {
        "effect": "coulomb_friction",
        "location": "left_knee",
        "parameters": {"torque": {"value": 1.9, "low": 1.7, "high": 2.1, "unit": "Nm"}},
    }
    diagnosis, overlay = tmp_path / "diagnosis.json", tmp_path / "overlay.yaml"
    diagnosis.write_text(
        json.dumps({"schema": 1, "verdict": "explained", "gap": {"closed": 0.9}, "causes": [cause]})
    )
    code, out, _ = run(
        capsys, "gap", "apply", str(diagnosis), "--robot", "hyperleg", "--out", str(overlay)
    )
    assert code == 0
    assert out.startswith("coulomb_friction at left_knee -> ")
    from hyperleg_design.gap.playback.overlay import read_overlay

    assert read_overlay(overlay).change == {("coulomb_friction", "left_knee"): {"torque": 1.9}}
    pytest.importorskip("rsl_rl")
    overlay.write_text(overlay.read_text().replace("left_knee", "left_kne"))
    code, _, err = run(
        capsys, "train", "--overlay", str(overlay), "--out", str(tmp_path / "training")
    )
    assert code == 2
    assert "did you mean left_knee" in err
    assert len(err.strip().splitlines()) == 1
    code, _, err = run(
        capsys,
        "evaluate",
        "nothing.onnx",
        "--overlay",
        str(tmp_path / "none.yaml"),
        "--out",
        str(tmp_path / "evaluation"),
    )
    assert code == 2
    assert "none.yaml: cannot be read" in err


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
    assert len(found["missing"]) == 31  # of four arms with eight seeds
    text = coverage_text(found)
    assert text.startswith("1 trainings are evaluated; 31 of the campaign's are missing: ")
    assert "walk_upright toe (seed 1, 2, 3, 4, 5, 6, 7)" in text


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
