"""Samples of trials that end one after another come back whole, each as long as its trial."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.evaluation import signal_blocks
from hyperleg_design.evaluation.signal_blocks import SignalBlocks

SUBSTEPS, COUNT, STEPS = 2, 5, 8
ENDS = np.array([4, 1, 8, 1, 6])
"""Policy steps for which each of the simulations runs."""


def samples(step, rows):
    """100 times the simulation and the number of the sample, and one value for each step."""
    now = step * SUBSTEPS + np.arange(SUBSTEPS)
    return {"count": (100.0 * rows + now[:, None])[..., None], "step": 0.0 * rows[None] + step}


@pytest.fixture(params=[(COUNT,), (2, COUNT), (1, 3, COUNT)])
def blocks(monkeypatch, request):
    """Three steps a block, of simulations in one part or in several."""
    monkeypatch.setattr(signal_blocks, "BLOCK", 3)
    kept = SignalBlocks()
    parts = np.split(np.arange(COUNT), request.param[:-1])
    for step in range(STEPS):
        kept.keep([samples(step, rows) for rows in parts], step < ENDS)
    return kept


def test_every_trial_has_its_own_samples(blocks):
    trials, steps = blocks.taken("count", ENDS), blocks.taken("step", ENDS)
    assert [len(trial) for trial in trials] == (ENDS * SUBSTEPS).tolist()
    assert [each.tolist() for each in steps] == [list(range(end)) for end in ENDS]
    for row, trial in enumerate(trials):
        assert trial[:, 0].tolist() == [100 * row + k for k in range(len(trial))]
        assert trial.flags.c_contiguous
    assert blocks.names == ()


def test_a_trial_that_ends_in_its_first_step_has_no_samples(blocks):
    trials = blocks.taken("count", np.where(ENDS == 1, 0, ENDS))
    assert [trial.shape for trial in trials] == [(8, 1), (0, 1), (16, 1), (0, 1), (12, 1)]


def test_the_latest_sample_is_of_the_trials_of_its_block(blocks):
    rows, values = blocks.latest("count")
    assert rows.tolist() == [2]
    assert values.tolist() == [[215.0]]
