"""A measure has one name and one value in `analyze`, `evaluate`, sweeps and searches."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from hyperleg_design.evaluation.evaluate import evaluate_many
from hyperleg_design.evaluation.policy_choice import policies_for
from hyperleg_design.evaluation.protocol import (
    Steady,
    TTestProtocol,
    WalkProtocol,
    protocol_mapping,
)
from hyperleg_design.report.evaluation_text import evaluation_rows
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.transmission import joint_names
from hyperleg_design.simulation.settings import Start
from hyperleg_design.sizing.analysis import analyze
from hyperleg_design.sweep import registry
from hyperleg_design.sweep.measuring import measures
from hyperleg_design.sweep.measuring.evaluate import evaluate_range
from hyperleg_design.sweep.search import run_search, search_of
from hyperleg_design.sweep.space import sweep_from_mapping
from hyperleg_design.sweep.trial_runs import evaluate_values
from hyperleg_design.sweep.trial_table import design_table
from hyperleg_design.sweep.trials.trial_plan import plan

NO_MEASURES = {
    "schema",
    "motors",  # constants of the catalogue and of the design, which are inputs
    "reduction",
    "reflected_inertia",  # a matrix; its diagonal is joint_limits.reflected_inertia
    "ablation_confound",  # of other variants
    "contact_force",  # of a design that writes its tree out: one optimisation a direction
}
"""What `analyze` prints besides measures of the design."""


def printed(design) -> dict[str, float]:
    """Numbers of an analysis by name, joints and segments after a dot."""
    numbers: dict[str, float] = {}

    def walk(entry, prefix):
        for key, value in entry.items():
            if isinstance(value, dict):
                walk(value, f"{prefix}{key}.")
            elif isinstance(value, int | float):
                numbers[prefix + key] = value

    walk({k: v for k, v in analyze(design).items() if k not in NO_MEASURES}, "")
    return numbers


def space(**changes):
    base = {
        "design": "hyperleg",
        "axes": {"toe.mass": {"values": [0.12, 0.3]}, "thigh.length": {"values": [0.33, 0.37]}},
    }
    return sweep_from_mapping(base | changes)


@pytest.mark.parametrize("name", ["toe", "toe_locked", "toe_removed_matched", "mini_cheetah"])
def test_all_that_analyze_prints_is_a_measure(name):
    design = load_robot(name)
    columns = measures.evaluate(design)
    for measure, value in printed(design).items():
        assert columns[measure][0] == value, measure
        assert registry.resolve(measure).name == measure


def test_a_column_of_a_sweep_has_the_value_that_analyze_prints():
    names = list(measures.measures_of(load_robot("hyperleg")))
    sweep = space(measures=names, variants=["toe", "toe_removed"])
    table = evaluate_range(sweep, 0, sweep.count)
    for row in (0, 3, 6):
        values = {axis.name: table[axis.name][[row]] for axis in sweep.axes}
        design = sweep.design(values, table["variant"][row]).take(0)
        for measure, value in printed(design).items():
            assert table[measure][row] == pytest.approx(value, rel=1e-12), measure


def test_an_objective_that_the_sweep_does_not_compute_has_the_value_that_analyze_prints(tmp_path):
    sweep = sweep_from_mapping(
        {
            "design": "hyperleg",
            "sampling": "sobol",
            "count": 1,
            "measures": ["total_mass"],
            "axes": {"toe.mass": {"low": 0.05, "high": 1.0}},
        }
    )
    names = ["segment_mass.toe", "joint_limits.max_torque.knee"]
    search = search_of(sweep, plan(sweep, []), names, ["max_joint_torque.toe>=0"])
    study = run_search(search, tmp_path, 2, progress=False)
    for trial in study.trials:
        design = sweep.design({"toe.mass": np.array([trial.params["toe.mass"]])}, "toe").take(0)
        numbers = printed(design)
        assert trial.values == pytest.approx([numbers[n] for n in names], rel=1e-12)
        row = trial.user_attrs["row"]
        assert row["max_joint_torque.toe"] == pytest.approx(numbers["max_joint_torque.toe"])


def test_joints_of_a_design_that_writes_its_tree_out_can_be_objectives():
    joint = joint_names(load_robot("mini_cheetah"))[0]
    data = {"design": "mini_cheetah", "axes": {"electrical.voltage_ratio": {"values": [0.8, 1.0]}}}
    sweep = sweep_from_mapping(data | {"objectives": [f"max_joint_torque.{joint}", "limb_mass"]})
    assert "limb_mass" in sweep.measures
    with pytest.raises(Exception, match=f"expects one of max_joint_torque.{joint}"):
        sweep_from_mapping(data | {"objectives": ["max_joint_torque.knee_of_another"]})


SHORT = {
    "walk": WalkProtocol(
        trials=6,
        distance=2.5,
        time_limit=4.0,
        steady=Steady(begin=0.5),
        start=Start(tilt=0.35, joint_position=0.05),
    ),
    "t_test": TTestProtocol(
        trials=2,
        time_limit=4.0,
        points={"A": (0.0, 0.0), "B": (1.2, 0.0), "C": (1.2, 1.0)},
        order=("A", "B", "C"),
    ),
}


@pytest.mark.parametrize(
    "kind", [pytest.param(k, marks=pytest.mark.slow if k == "t_test" else ()) for k in SHORT]
)
def test_all_that_evaluate_prints_is_a_column_and_an_objective(kind, tmp_path):
    """The same trials give the same bits."""
    policies = [p.path for p in policies_for(kind, load_robot("toe"), 1)]
    sweep = space(axes={"toe.mass": {"values": [0.12, 0.3]}})
    values = {"toe.mass": np.array([0.3])}
    design = sweep.design(values, "toe").take(0)
    evaluations = evaluate_many(policies, SHORT[kind], designs=[design] * len(policies), workers=1)
    rows = {row["measure"]: row for row in evaluation_rows(evaluations)}
    mapping, sample = protocol_mapping(SHORT[kind]), np.array([0])
    trials = pd.concat(
        [evaluate_values(sweep, "toe", values, sample, mapping, policy) for policy in policies],
        ignore_index=True,
    )
    columns = {"sample": sample, "variant": np.array(["toe"]), **values}
    table = design_table(sweep, trials, columns).iloc[0]
    assert rows.keys() >= registry.PROTOCOLS[kind].keys() - {"arrived"}
    for name, row in rows.items():
        entry = registry.resolve(name, [kind])
        assert entry.unit == row["unit"], name
        value = table[entry.name]
        assert (None if np.isnan(value) else value) == row["mean"], name
    fell = table[f"{kind}.fell"]
    assert kind != "walk" or 0 < fell < 1  # so that the test holds with falls, too

    objective = "power"
    drawn = {"sampling": "sobol", "count": 1, "axes": {"toe.mass": {"low": 0.1, "high": 0.3}}}
    wide = space(**drawn)
    search = search_of(
        wide, plan(wide, [SHORT[kind]], seeds=len(policies)), [objective], [f"{kind}.fell<=1"]
    )
    study = run_search(search, tmp_path, 1, progress=False)
    again = wide.design({"toe.mass": np.array([study.trials[0].params["toe.mass"]])}, "toe").take(0)
    evaluations = evaluate_many(policies, SHORT[kind], designs=[again] * len(policies), workers=1)
    rows = {row["measure"]: row for row in evaluation_rows(evaluations)}
    assert study.trials[0].values == [rows[objective]["mean"]]
