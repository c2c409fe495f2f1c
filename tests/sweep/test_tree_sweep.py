"""Sweeps of robots that write their tree out."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.report.sweep.trials import evaluated_report
from hyperleg_design.robot import transmission
from hyperleg_design.robot.kinematics.dimensions import total_mass
from hyperleg_design.robot.load import load_robot
from hyperleg_design.sweep.measuring import measure, measures
from hyperleg_design.sweep.run import run_sweep
from hyperleg_design.sweep.space import sweep_from_mapping
from hyperleg_design.sweep.trial_runs import TRIALS, run_trials
from hyperleg_design.sweep.trial_table import build_command, design_table
from hyperleg_design.sweep.trials.trial_plan import plan

SHORT = WalkProtocol(trials=2, distance=0.6, time_limit=1.2, steady=Steady(begin=0.3))

SWEEP = {
    "design": "parallel_ankle",
    "axes": {
        "actuators.knee.gear": {"low": 20, "high": 30, "steps": 3},
        "actuators.ankle_outer.motor": {"values": ["RI80", "RI70"]},
    },
}


def test_each_row_is_the_robot_with_these_values(tmp_path):
    sweep = sweep_from_mapping(SWEEP)
    result = run_sweep(sweep, tmp_path / "out", progress=False)
    names = ("actuators.knee.gear", "actuators.ankle_outer.motor", "total_mass")
    table = result.columns([*names, "max_joint_torque.knee", "torque_alone.ankle_roll"])
    assert len(table["total_mass"]) == 6
    for row in range(6):
        values = {name: table[name][row] for name in names[:2]}
        design = load_robot("parallel_ankle", overrides=values)
        assert table["total_mass"][row] == pytest.approx(float(total_mass(design)))
        torque = transmission.max_joint_torque(design)
        assert table["max_joint_torque.knee"][row] == pytest.approx(torque[3])
    assert np.all(table["torque_alone.ankle_roll"] > 0)


def test_measures_that_need_hyperleg_are_refused_by_name():
    design = load_robot("mini_cheetah")
    assert "push_off_power" not in measures.measures_of(design)
    assert set(measures.measures_of(design)) < set(measure.MEASURES)
    with pytest.raises(InputError, match="push_off_power"):
        sweep_from_mapping(SWEEP | {"measures": ["push_off_power"]})


def test_a_tree_has_no_variants():
    with pytest.raises(InputError, match=r"variants.*has none"):
        sweep_from_mapping(SWEEP | {"variants": ["toe"]})


def test_a_tree_that_no_policy_was_trained_for_is_refused_before_anything_is_written():
    sweep = sweep_from_mapping(SWEEP | {"evaluate": ["walk"]})
    with pytest.raises(InputError, match=r"no policy.*--design parallel_ankle.*--policies FOLDER"):
        plan(sweep, sweep.evaluated)


def test_a_sweep_of_a_quadruped_walks(tmp_path):
    """Each row has the numbers of the design by itself, and a command that builds it."""
    axes = {"trunk": {"paths": ["links.trunk.mass"], "scale": [1.0, 1.3]}}
    sweep = sweep_from_mapping(
        {"design": "mini_cheetah", "measures": ["total_mass"], "axes": axes, "evaluate": ["walk"]}
    )
    result = run_sweep(sweep, tmp_path / "out", progress=False)
    run_trials(result, plan(sweep, [SHORT]), progress=False)
    trials = pd.read_parquet(result.folder / TRIALS)
    assert trials["trained"].tolist() == ["specialist"] * 2 + ["zero-shot"] * 2
    heavier = load_robot("mini_cheetah", overrides={"links.trunk.mass": 1.3 * 3.52})
    alone = evaluate("walk_any-mini_cheetah-0", SHORT, design=heavier)
    rows = trials[trials["sample"] == 1]
    assert rows["outcome"].tolist() == alone.outcomes
    for name in alone.measures[0]:
        np.testing.assert_array_equal(rows[name], alone.values(name), err_msg=name)
    designs = design_table(sweep, trials, result.columns())
    command = "hyperleg build --design mini_cheetah --set 'links.trunk.mass=4.576' --out built"
    assert build_command(sweep, dict(designs.iloc[1])) == command
    assert evaluated_report(result)["designs"] == 2


def test_an_impossible_sample_is_rejected_and_says_why(tmp_path):
    axes = {"joints.knee.default_deg": {"low": 40, "high": 200, "steps": 2}}
    sweep = sweep_from_mapping(SWEEP | {"axes": axes})
    result = run_sweep(sweep, tmp_path / "out", progress=False)
    table = result.columns(["rejected", "total_mass"])
    assert table["rejected"][0] == ""
    assert "default_deg" in table["rejected"][1]
    assert np.isnan(table["total_mass"][1])
