from __future__ import annotations

import dataclasses

import pytest

from hyperleg_design.errors import OutputError
from hyperleg_design.evaluation.policy import standing
from hyperleg_design.evaluation.protocol import WalkProtocol
from hyperleg_design.evaluation.protocols.walk import measure_walk
from hyperleg_design.evaluation.result import evaluation_of
from hyperleg_design.evaluation.result_tables import (
    cycle_table,
    motor_table,
    policy_table,
    trial_table,
    write_results,
)
from hyperleg_design.evaluation.rollout import FELL


@pytest.fixture(scope="module")
def evaluations(planned_trial, design):
    protocol = WalkProtocol()
    trials = [planned_trial, dataclasses.replace(planned_trial, outcome=FELL)]
    parts = [list(p) for p in zip(*(measure_walk(t, protocol) for t in trials), strict=True)]
    one = evaluation_of(standing(14), design, protocol, trials, *parts)
    return [
        dataclasses.replace(one, policy=f"p{k}", seed=seed, steps=k)
        for k, seed in enumerate([0, 0, 1, -1, -1])
    ]


def test_a_row_a_trial(evaluations):
    table = trial_table(evaluations)
    assert len(table) == 10
    assert table["outcome"].tolist() == ["arrived", "fell"] * 5
    assert (
        table.loc[0, "steady_cost_of_transport"]
        == evaluations[0].measures[0]["steady_cost_of_transport"]
    )
    assert table["variant"].unique().tolist() == ["toe"]


def test_a_row_a_policy_with_means_of_what_did_not_fall(evaluations):
    trials, table = trial_table(evaluations), policy_table(evaluations)
    assert table["policy"].tolist() == ["p0", "p1", "p2", "p3", "p4"]
    assert table["fell"].tolist() == [0.5] * 5
    arrived = trials[(trials["policy"] == "p2") & (trials["outcome"] == "arrived")]
    cost = table.loc[2, "steady_cost_of_transport"]
    assert cost == arrived["steady_cost_of_transport"].mean()


def test_a_row_a_motor_of_trials_that_have_a_steady_state(evaluations):
    table = motor_table(evaluations)
    assert len(table) == 5 * 14
    assert table.loc[2, "motor"] == "left_hip_pitch"
    assert table.loc[2, "rms_torque"] == pytest.approx(evaluations[0].motors[0].rms_torque[2])


def test_letting_signals_go_changes_no_table(evaluations):
    light = [one.light() for one in evaluations]
    assert [len(one.trials) for one in light] == [1] * 5
    for table in (trial_table, motor_table, cycle_table):
        assert table(light).equals(table(evaluations))


def test_the_cycle_table_is_the_mean_over_strides(evaluations):
    table = cycle_table(evaluations[:1])
    cycle = evaluations[0].cycles[0]
    assert len(table) == 101 * (7 + 7)
    knee = table[(table["kind"] == "mechanical") & (table["part"] == "knee")]
    assert knee["mean"].to_numpy() == pytest.approx(cycle.mechanical[:, :, 3].mean(0))
    assert knee["strides"].unique().tolist() == [len(cycle.mechanical)]
    assert cycle_table([dataclasses.replace(evaluations[0], cycles=[None, None])]).empty


def test_results_are_written_whole_and_the_same_again(evaluations, tmp_path):
    import json

    import pandas as pd

    first, second = (write_results(tmp_path / name, evaluations) for name in ("a", "b"))
    names = {
        "policies.csv",
        "trials.parquet",
        "motors.parquet",
        "cycles.parquet",
        "paths.parquet",
        "evaluation.json",
    }
    assert {p.name for p in first.iterdir()} == names | {".hyperleg"}
    for name in names:
        assert (first / name).read_bytes() == (second / name).read_bytes()
    assert pd.read_parquet(first / "trials.parquet").equals(trial_table(evaluations))
    assert pd.read_csv(first / "policies.csv")["trials"].tolist() == [2] * 5
    described = json.loads((first / "evaluation.json").read_text())
    assert described["protocols"][0]["distance"] == 20
    assert [p["seed"] for p in described["policies"]] == [0, 0, 1, -1, -1]
    assert described["versions"]["mujoco"]
    foreign = tmp_path / "foreign"
    foreign.mkdir()
    (foreign / "mine.txt").write_text("mine")
    with pytest.raises(OutputError, match="did not write"):
        write_results(foreign, evaluations)
