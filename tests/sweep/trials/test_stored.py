"""Committed trials are small, belong to their definition, and can be run again."""

from __future__ import annotations

import dataclasses

import numpy as np
import pandas as pd
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.sweep.run import SweepResult, run_sweep
from hyperleg_design.sweep.space import sweep_from_mapping
from hyperleg_design.sweep.trial_runs import TRIALS, run_trials, trials_state
from hyperleg_design.sweep.trial_table import design_table
from hyperleg_design.sweep.trials import stored
from hyperleg_design.sweep.trials.trial_plan import plan

SHORT = WalkProtocol(trials=2, distance=1.5, time_limit=3.0, steady=Steady(begin=0.3))
SWEEP = {
    "name": "masses",
    "design": "hyperleg",
    "measures": ["total_mass"],
    "evaluate": ["walk"],
    "axes": {"toe.mass": {"values": [0.1, 0.2, 0.3]}},
    "maps": [{"x": "toe.mass", "measure": "walk.path"}],
}


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A sweep with its trials, and what ran."""
    folder = tmp_path_factory.mktemp("stored") / "out"
    result = run_sweep(sweep_from_mapping(SWEEP), folder, progress=False)
    wanted = plan(result.sweep, [SHORT], seeds=1)
    run_trials(result, wanted, progress=False)
    return result, wanted


@pytest.fixture(scope="module")
def committed(ran, tmp_path_factory):
    result, wanted = ran
    path = stored.store(result, tmp_path_factory.mktemp("small") / "masses.parquet")
    state = trials_state(path)
    assert state["plan"] == wanted.digest
    assert state["commit"] == result.summary["commit"]
    return stored.Stored(result.sweep, pd.read_parquet(path), state["plan"], state["commit"])


def test_what_pages_show_is_kept_in_single_precision(ran, committed):
    result, _ = ran
    whole = pd.read_parquet(result.folder / TRIALS)
    assert len(committed.trials) == len(whole) == 6
    assert len(committed.trials.columns) < len(whole.columns) / 2
    np.testing.assert_allclose(committed.trials["path"], whole["path"], rtol=1e-6)  # of the map
    small = design_table(result.sweep, committed.trials, result.columns())
    large = design_table(result.sweep, whole, result.columns())
    np.testing.assert_allclose(small["walk.mean_speed"], large["walk.mean_speed"], rtol=1e-6)
    assert small["walk.limits"].tolist() == large["walk.limits"].tolist()


def test_the_same_trials_run_again_are_the_same(ran, committed):
    _, wanted = ran
    again = stored.rerun(committed, wanted, count=2)
    assert (again.designs, again.trials, again.same_outcomes) == (2, 4, 4)
    assert again.largest_difference < 1e-6
    assert again.policy == "walk_upright-toe-0"


def test_a_trial_that_differs_is_seen(ran, committed):
    _, wanted = ran
    changed = committed.trials.copy()
    changed.loc[changed["sample"] == 1, "cost_of_transport"] *= np.float32(1.1)
    changed.loc[changed["sample"] == 1, "outcome"] = "lost"
    other = dataclasses.replace(committed, trials=changed)
    again = stored.rerun(other, wanted, count=1)  # the middle one
    assert again.same_outcomes == 0
    assert again.largest_difference == pytest.approx(1 - 1 / 1.1, rel=1e-3)


def test_trials_of_another_definition_are_refused(ran, tmp_path, monkeypatch):
    result, _ = ran
    other = sweep_from_mapping({**SWEEP, "axes": {"toe.mass": {"values": [0.1, 0.2]}}})
    with pytest.raises(InputError, match="trials of this sweep"):
        stored.store(SweepResult(other, result.folder, result.summary), tmp_path / "a.parquet")
    (tmp_path / stored.WALKED).mkdir()
    stored.store(result, tmp_path / stored.WALKED / "masses.parquet")
    monkeypatch.setattr(stored, "_folder", lambda: tmp_path / stored.WALKED)
    monkeypatch.setattr(stored, "load_sweep", lambda name: other)
    assert stored.stored_names() == ["masses"]
    with pytest.raises(InputError, match="another definition"):
        stored.stored("masses")
    (tmp_path / stored.WALKED / "masses.parquet").write_bytes(b"PAR1")
    with pytest.raises(InputError, match="cannot be read"):
        stored.stored("masses")


@pytest.mark.parametrize("name", stored.stored_names())
def test_shipped_trials_are_of_the_shipped_definitions_and_policies(name):
    shipped = stored.stored(name)
    assert shipped.plan == plan(shipped.sweep, shipped.sweep.evaluated).digest
    assert set(shipped.trials["sample"]) == set(range(shipped.sweep.count))
