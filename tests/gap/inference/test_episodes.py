from types import SimpleNamespace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.episodes import episodes, of_time, together

TICKS, STEP = 4000, 0.005


def jumpy(signals, time):
    """One drive alone jumps."""
    column = next(c for c in signals if c.startswith("motor_torque/"))
    return {**signals, column: signals[column] + 3.0 * ((time % 2.0) < 0.05)}


def test_rare_large_residuals_are_set_apart(robot_files):
    log = diagnosed.run("healthy", 0)
    spoiled = diagnosed.prepared(
        robot_files["coupled"], log.changed(signals=jumpy(log.signals, log.time))
    )
    samples = spoiled.base.samples
    assert samples.episodic[samples.group].mean() > 0.005
    assert episodes(diagnosed.prepared(robot_files["coupled"], log).base).mean() < 0.05


def drives(wild):
    """Samples of three drives in one band, and what is left of them: noise, and 20 times as much
    where `wild (3, t)`.
    """
    row = np.repeat(np.arange(3), TICKS)
    samples = SimpleNamespace(
        rows=[SimpleNamespace(residual_name="drive")] * 3,
        share=np.ones(3 * TICKS),
        log=np.zeros(1, int),
        part=np.zeros(3 * TICKS, int),
        time=np.tile(np.arange(TICKS) * STEP, 3),
        row=row,
        group=row,
        group_row=np.arange(3),
        group_band=np.ones(3, int),
    )
    left = np.random.default_rng(0).normal(size=3 * TICKS) * np.where(wild.ravel(), 20.0, 1.0)
    return samples, left


@pytest.mark.parametrize(
    ("together_with", "least", "most"), [(3, 0.08, 0.12), (2, 0.08, 0.12), (1, 0.0, 0.001)]
)
def test_what_happens_to_most_drives_at_once_is_told_from_what_happens_to_one(
    together_with, least, most
):
    wild = np.zeros((3, TICKS), bool)
    wild[:together_with] = (np.arange(TICKS) * STEP) % 1.0 < 0.1
    assert least <= together(*drives(wild)) <= most


def test_drives_that_jump_in_turn_are_no_lost_commands():
    time = np.arange(TICKS) * STEP
    assert together(*drives(np.stack([(time + k) % 3.0 < 0.1 for k in range(3)]))) < 0.001


def test_one_drive_is_too_few(robot_files):
    samples, left = drives(np.ones((3, TICKS), bool))
    samples.rows = [SimpleNamespace(residual_name="motion")] * 2 + [
        SimpleNamespace(residual_name="drive")
    ]
    assert together(samples, left) == 0.0


def test_joints_tell_where_nobody_measured_the_drives():
    wild = np.zeros((3, TICKS), bool)
    wild[:2] = (np.arange(TICKS) * STEP) % 1.0 < 0.1
    samples, left = drives(wild)
    samples.rows = [SimpleNamespace(residual_name="motion")] * 3
    assert together(samples, left) == 0.0
    assert 0.08 <= together(samples, left, "motion") <= 0.12


def test_how_much_of_the_time_a_row_is_in_episodes():
    samples = diagnosed.in_episodes(0.25, "drive", "motion")
    assert of_time(samples, 0) == pytest.approx(0.25)
    samples.group[samples.row == 1] = 0
    assert of_time(samples, 1) == 0
