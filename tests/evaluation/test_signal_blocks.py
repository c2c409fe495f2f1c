"""Signals of trials that end one after another come back whole, each as long as its trial."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.evaluation import signal_blocks
from hyperleg_design.evaluation.signal_blocks import SignalBlocks
from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import load_task

SUBSTEPS = 2


class Counting:
    """An environment whose signal is 100 times the simulation and the number of the sample."""

    def __init__(self) -> None:
        self.samples = 0

    def keep_signals(self, store, samples, kept):
        now = self.samples + np.arange(SUBSTEPS)
        store["count"][samples] = (100 * kept + now[:, None])[..., None]
        self.samples += SUBSTEPS


@pytest.fixture
def blocks(monkeypatch):
    """Three steps a block; the trials run for 4, 1 and 8 steps."""
    monkeypatch.setattr(signal_blocks, "BLOCK", 3)
    environment, kept = Counting(), SignalBlocks({"count": (1,)}, SUBSTEPS)
    for step in range(8):
        kept.keep(environment, np.array([step < 4, step < 1, True]))
    return kept


def test_every_trial_has_its_own_samples(blocks):
    trials = blocks.taken("count", np.array([8, 1, 16]))
    assert [len(trial) for trial in trials] == [8, 1, 16]
    for row, trial in enumerate(trials):
        assert trial[:, 0].tolist() == [100 * row + k for k in range(len(trial))]
        assert trial.flags.c_contiguous
    assert blocks.names == ()


def test_the_latest_sample_is_of_the_trials_of_its_block(blocks):
    rows, values = blocks.latest("count")
    assert rows.tolist() == [2]
    assert values.tolist() == [[215.0]]


def test_simulations_in_several_chunks_are_told_apart():
    """The same signals as those that the environment gives, for a few of its simulations."""
    environment = Environment(load_design("toe"), load_task("walk"), simulations=33)
    assert len(environment.chunks) == 2
    environment.recording = True
    environment.reset()
    environment.step(np.zeros((33, environment.action_size)))
    whole = environment.signals()
    kept = np.array([1, 2, 20, 32])
    samples = whole["joint_position"].shape[1]
    store = {"joint_position": np.empty((samples, 4, environment.action_size))}
    environment.keep_signals(store, slice(0, samples), kept)
    environment.close()
    assert np.array_equal(np.moveaxis(store["joint_position"], 0, 1), whole["joint_position"][kept])
