"""LeRobot datasets of evaluations, read back by the package's own reader of LeRobot datasets."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.evaluate import evaluate_many
from hyperleg_design.evaluation.lerobot import write_lerobot
from hyperleg_design.gap.logs.readers import open_log


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
    logs = open_log(folder, metadata={"units": {"position": "rad"}})
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
    rows = pd.read_parquet(folder / "meta/episodes/chunk-000/file-000.parquet")
    assert rows["dataset_to_index"].iloc[-1] == info["total_frames"]
    assert rows["length"].sum() == info["total_frames"]


def test_trials_without_signals_are_refused(evaluated, tmp_path):
    light = [one.light(0) for one in evaluated]
    with pytest.raises(InputError, match="expects trials with their signals"):
        write_lerobot(tmp_path / "set", light)
    assert not (tmp_path / "set").exists()
