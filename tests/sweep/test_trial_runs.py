from __future__ import annotations

import io
import shutil
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas as pd
import pytest

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.evaluation.shipped import find_policy
from hyperleg_design.sweep import trial_runs
from hyperleg_design.sweep.run import run_sweep
from hyperleg_design.sweep.space import sweep_from_mapping
from hyperleg_design.sweep.trial_runs import REJECTED, TRIALS, run_trials
from hyperleg_design.sweep.trials.trial_plan import plan

SHORT = WalkProtocol(trials=2, distance=0.6, time_limit=0.8, steady=Steady(begin=0.3))
SWEEP = {
    "design": "hyperleg",
    "sampling": "grid",
    "measures": ["total_mass"],
    "axes": {
        "leg length": {"paths": ["thigh.length", "shank.length"], "scale": [0.3, 1.0, 1.1]},
    },
}
"""Legs of 0.3 times the length let the pelvis stand lower than a fall."""


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """The sweep with its trials, from one run."""
    result = run_sweep(
        sweep_from_mapping(SWEEP), tmp_path_factory.mktemp("sweep") / "out", progress=False
    )
    wanted = plan(result.sweep, [SHORT], seeds=2)
    run_trials(result, wanted, batch=2, progress=False)
    return result, wanted


def copy_of(finished, tmp_path):
    """The sweep before its trials."""
    result, _ = finished
    shutil.copytree(result.folder, tmp_path / "out")
    (tmp_path / "out" / TRIALS).unlink()
    return run_sweep(result.sweep, tmp_path / "out", progress=False)


def test_trials_are_those_of_each_design_alone(finished):
    result, wanted = finished
    trials = pd.read_parquet(result.folder / TRIALS)
    sweep = result.sweep
    designs = sweep.design(sweep.samples(), "toe")
    for policy in wanted.policies["walk", "toe"]:
        for sample in (1, 2):
            alone = evaluate(policy.path, SHORT, design=designs.take(sample))
            rows = trials[
                (trials["sample"] == sample) & (trials["policy"] == policy.training)
            ].sort_values("trial")
            assert rows["outcome"].tolist() == alone.outcomes
            for name in alone.measures[0]:
                np.testing.assert_array_equal(rows[name], alone.values(name), err_msg=name)
            assert set(rows["trained"]) == {alone.trained.kind}
    outside = trials.loc[trials["sample"] == 2, "outside"]
    assert outside.str.startswith("thigh.length, shank.length").all()


def test_a_design_that_cannot_stand_is_a_row_that_says_so(finished):
    trials = pd.read_parquet(finished[0].folder / TRIALS)
    lost = trials[trials["sample"] == 0]
    assert lost["outcome"].tolist() == [REJECTED] * 2
    assert all("lower than a fall" in reason for reason in lost["reason"])


def test_a_killed_run_goes_on_and_gives_the_same_table(finished, tmp_path, monkeypatch):
    result, wanted = finished
    again = copy_of(finished, tmp_path)
    calls, whole = [], trial_runs.evaluate_batch

    def stopped(*arguments):
        calls.append(arguments)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return whole(*arguments)

    monkeypatch.setattr(trial_runs, "evaluate_batch", stopped)
    with pytest.raises(KeyboardInterrupt):
        run_trials(again, wanted, batch=2, progress=False)
    run_trials(again, wanted, batch=2, progress=False)
    assert len(calls) == 2 + 3  # four batches in all, one of them before the stop
    assert (again.folder / TRIALS).read_bytes() == (result.folder / TRIALS).read_bytes()
    run_trials(again, wanted, batch=2, progress=False)
    assert len(calls) == 5
    assert not (again.folder / trial_runs.CHUNKS).exists()


def test_a_batch_that_cannot_be_read_is_run_again(finished, tmp_path, monkeypatch):
    result, wanted = finished
    again = copy_of(finished, tmp_path)
    run = []

    def stopped(*arguments):
        run.append(arguments)
        if len(run) == 3:
            raise KeyboardInterrupt
        return trial_runs._parquet(pd.DataFrame({"sample": [0]}))

    with monkeypatch.context() as patched:
        patched.setattr(trial_runs, "evaluate_batch", stopped)
        with pytest.raises(KeyboardInterrupt):
            run_trials(again, wanted, batch=2, progress=False)
    for path in (again.folder / trial_runs.CHUNKS).glob("*.parquet"):
        path.write_bytes(path.read_bytes()[:40])
    with ThreadPoolExecutor(1) as executor:
        run_trials(again, wanted, batch=2, executor=executor, progress=False)
    assert (again.folder / TRIALS).read_bytes() == (result.folder / TRIALS).read_bytes()


def test_trials_of_another_plan_are_not_mixed(finished, tmp_path, monkeypatch):
    again = copy_of(finished, tmp_path)

    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(trial_runs, "evaluate_batch", stopped)
    with pytest.raises(KeyboardInterrupt):
        run_trials(again, finished[1], batch=2, progress=False)
    with pytest.raises(OutputError, match="other protocols or policies"):
        run_trials(again, plan(again.sweep, [SHORT], seeds=1), batch=2, progress=False)


def test_a_toe_layout_without_policies_is_one_clear_error(tmp_path):
    sweep = sweep_from_mapping(SWEEP | {"variants": ["toe", "toe_locked"]})
    name = "t_test_free-toe-0"
    shutil.copytree(find_policy(name).parent, tmp_path / "toe" / name)
    with pytest.raises(InputError, match="toe layout"):
        plan(sweep, ["t_test"], policies=[tmp_path / "toe"])
    with pytest.raises(InputError, match="no such folder"):
        plan(sweep, ["walk"], policies=[tmp_path / "none"])
    with pytest.raises(InputError, match="one of each kind"):
        plan(sweep, ["walk", SHORT])


def test_tables_are_parquet(finished):
    rows = pd.DataFrame({"sample": [1, 2]})
    assert pd.read_parquet(io.BytesIO(trial_runs._parquet(rows))).equals(rows)
