"""LeRobot datasets of evaluations, read back by the package's own reader of LeRobot datasets."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pandas as pd
import pytest

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.evaluate import evaluate_many
from hyperleg_design.evaluation.lerobot import write_lerobot
from hyperleg_design.gap.checks.check import check_log
from hyperleg_design.gap.logs.readers import open_log
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.robot.load import load_robot


@pytest.fixture
def evaluated(make_onnx, tmp_path):
    protocol = tmp_path / "short.yaml"
    text = (resources.content_folder("sim") / "protocol_walk.yaml").read_text()
    protocol.write_text(text.replace("trials: 10", "trials: 2"))
    return evaluate_many([make_onnx()], protocol, workers=1, kept=2)


def test_a_dataset_reads_back_as_what_was_simulated(evaluated, tmp_path):
    folder = write_lerobot(tmp_path / "set", evaluated)
    info = json.loads((folder / "meta" / "info.json").read_text())
    trials = evaluated[0].trials
    assert info["codebase_version"] == "v3.0"
    assert info["total_episodes"] == len(trials) == 2
    assert info["fps"] == 50
    logs = open_log(folder)
    assert len(logs) == 2
    for log, trial in zip(logs, trials, strict=True):
        joint = trial.layout.joints[3]
        for column, signal in (("position", "joint_position"), ("position_target", "joint_target")):
            np.testing.assert_allclose(
                log.column(f"{column}/{joint}"),
                getattr(trial, signal)[:: trial.substeps, 3],
                rtol=1e-6,
                atol=1e-6,
            )
        height = trial.base_position[:: trial.substeps, 2]
        np.testing.assert_allclose(log.column("base_position/z"), height, rtol=1e-6)
        lean = trial.base_orientation[:: trial.substeps, 0]
        np.testing.assert_allclose(log.column("base_orientation/w"), lean, rtol=1e-6)
    rows = pd.read_parquet(folder / "meta/episodes/chunk-000/file-000.parquet")
    assert rows["dataset_to_index"].iloc[-1] == info["total_frames"]
    assert rows["length"].sum() == info["total_frames"]


def test_a_dataset_says_what_a_diagnosis_has_to_know(evaluated, tmp_path):
    folder = write_lerobot(tmp_path / "set", evaluated)
    trial = evaluated[0].trials[0]
    limb = trial.design.joint_sections
    for log in open_log(folder):
        subject = load_subject(logs=[log])
        what = [finding.what for finding in check_log(log, subject).findings]
        assert not [
            t
            for t in (*what, *log.metadata.remarks)
            if "lacks" in t or "gains" in t or "taken as" in t
        ]
        assert log.metadata.base == "floating"
        named = load_robot(folder / log.metadata.robot)
        assert named.to_mapping() == trial.design.to_mapping()
        for joint, (stiffness, damping) in log.metadata.gains.items():
            section = limb[joint.partition("_")[2]]
            assert (stiffness, damping) == (section.stiffness, section.damping)
        assert tuple(log.metadata.gains) == trial.layout.joints


def test_gains_that_differ_between_robots_are_left_out(evaluated, tmp_path):
    (evaluation,) = evaluated
    stiffer = evaluation.robot.with_values({"joints.knee.stiffness": 123.0})
    other = [dataclasses.replace(trial, design=stiffer) for trial in evaluation.trials]
    both = [evaluation, dataclasses.replace(evaluation, trials=other)]
    for log in open_log(write_lerobot(tmp_path / "set", both)):
        assert log.metadata.gains == {}
        assert log.metadata.robot == ""


def test_trials_without_signals_are_refused(evaluated, tmp_path):
    light = [one.light(0) for one in evaluated]
    with pytest.raises(InputError, match="expects trials with their signals"):
        write_lerobot(tmp_path / "set", light)
    assert not (tmp_path / "set").exists()
