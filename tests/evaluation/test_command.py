"""`hyperleg evaluate` from file to tables."""

from __future__ import annotations

import json

import pandas as pd
import pytest

from hyperleg_design import cli, resources


def test_a_standing_policy_is_evaluated_and_its_falls_are_counted(make_onnx, tmp_path, capsys):
    protocol = tmp_path / "short.yaml"
    protocol.write_text(
        (resources.content_folder("sim") / "protocol_walk.yaml")
        .read_text()
        .replace("trials: 10", "trials: 3")
    )
    code = cli.main(
        [
            "evaluate",
            str(make_onnx()),
            "--protocol",
            str(protocol),
            "--out",
            str(tmp_path / "out"),
            "--workers",
            "1",
            "--json",
        ]
    )
    found = json.loads(capsys.readouterr().out)
    assert code == 0
    table = pd.read_parquet(tmp_path / "out" / "trials.parquet")
    assert len(table) == 3
    fell = next(r for r in found["results"] if r["measure"] == "fell")
    assert fell["trials"] == 3
    assert fell["mean"] == pytest.approx(table["fell"].mean())
    assert fell["low"] <= fell["mean"] <= fell["high"]


def test_a_truncated_policy_stops_before_anything_is_written(make_onnx, tmp_path, capsys):
    broken = tmp_path / "broken.onnx"
    broken.write_bytes(make_onnx().read_bytes()[:100])
    code = cli.main(["evaluate", str(broken), "--out", str(tmp_path / "out")])
    assert code == 2
    assert "broken.onnx" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_every_trial_can_be_saved_as_a_log(make_onnx, tmp_path, capsys):
    from hyperleg_design.gap.checks.check import check_log
    from hyperleg_design.gap.logs.log import read_log

    protocol = tmp_path / "short.yaml"
    protocol.write_text(
        (resources.content_folder("sim") / "protocol_walk.yaml")
        .read_text()
        .replace("trials: 10", "trials: 3")
    )
    arguments = [
        "evaluate",
        str(make_onnx()),
        "--protocol",
        str(protocol),
        "--out",
        str(tmp_path / "out"),
        "--workers",
        "1",
    ]
    assert cli.main([*arguments, "--logs", str(tmp_path / "logs"), "--json"]) == 0
    paths = json.loads(capsys.readouterr().out)["logs"]
    assert len(paths) == len(list((tmp_path / "logs").glob("*.parquet"))) == 3
    log = read_log(paths[0])
    assert len(log.joints) == len(log.motors) == 14
    assert log.metadata.extra["outcome"] == "fell"
    assert check_log(log).usable


def test_a_policy_is_evaluated_on_another_design_and_says_so(make_onnx, tmp_path, capsys):
    overlay = tmp_path / "heavier.yaml"
    overlay.write_text("thigh: {mass: 6.0}\n")
    protocol = tmp_path / "short.yaml"
    protocol.write_text(
        "kind: walk\nname: short\ntrials: 2\ndistance: 1.0\ntime_limit: 1.0\nsteady: {begin: 0.5}\n"
    )
    arguments = ["evaluate", str(make_onnx()), "--protocol", str(protocol), "--json"]
    changes = ["--set", "toe.mass=0.5", "--set-file", str(overlay)]
    for name, more, kind, words in (
        ("own", [], "specialist", ""),
        ("set", changes, "zero-shot", "toe.mass"),
        ("named", ["--design", "toe", *changes], "zero-shot", "thigh.mass"),
    ):
        assert cli.main([*arguments, *more, "--out", str(tmp_path / name)]) == 0
        found = json.loads(capsys.readouterr().out)
        assert {row["trained"] for row in found["results"]} == {kind}
        (said,) = found["trained"].values()
        assert words in said
    trials = pd.read_parquet(tmp_path / "set" / "trials.parquet")
    assert set(trials["outside"]) == {"thigh.mass, toe.mass"}


def test_a_policy_for_another_toe_layout_is_one_clear_error(make_onnx, tmp_path, capsys):
    arguments = ["evaluate", str(make_onnx()), "--design", "toe_removed"]
    assert cli.main([*arguments, "--out", str(tmp_path / "out")]) == 2
    assert "another layout" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
