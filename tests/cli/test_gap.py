"""Verbs of the gap."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hyperleg_design import cli


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = cli.main(list(arguments))
    out, err = capsys.readouterr()
    return code, out, err


def test_gap_lists_its_effects(capsys):
    code, out, _ = run(capsys, "gap", "effects", "--json")
    found = {row["effect"]: row for row in json.loads(out)}
    assert code == 0
    assert len(found) >= 24
    assert found["backlash"]["where"] == "motor"
    assert run(capsys, "gap", "effects")[1].startswith("actuator_bandwidth")


@pytest.mark.slow
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


def test_gap_alone_shows_its_verbs(capsys):
    code, out, _ = run(capsys, "gap")
    assert code == 0
    assert "effects" in out
    assert "apply" in out
    code, _, err = run(capsys, "gap", "shwo")
    assert code == 2
    assert len(err.strip().splitlines()) == 1
