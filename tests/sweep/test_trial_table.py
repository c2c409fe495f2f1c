from __future__ import annotations

import shlex

import numpy as np
import pandas as pd
import pytest

from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.parameters.values import leaves
from hyperleg_design.sweep.space import load_sweep, sweep_from_mapping
from hyperleg_design.sweep.spaces.definition import AS_DESCRIBED
from hyperleg_design.sweep.trial_table import (
    acting_limits,
    best,
    build_command,
    design_table,
    front,
    sensitivities,
    view_command,
    walks,
)
from hyperleg_design.sweep.trials.stored import stored

COST = "walk.cost_of_transport"


@pytest.fixture(scope="module")
def sweep():
    return load_sweep("walk_reductions_and_toe_mass")


def power_law(sweep):
    """Designs whose cost is a power law of knee reduction and toe mass."""
    table = pd.DataFrame(sweep.samples())
    table.insert(0, "sample", np.arange(len(table)))
    table["variant"] = "toe"
    table[COST] = 0.3 * table["knee reduction"] ** -0.5 * table["toe.mass"] ** 0.1
    table["walk.arrived"] = 1.0
    return table


def test_elasticities_of_a_power_law(sweep):
    rows = sensitivities(sweep, power_law(sweep), [COST])
    found = {row["parameter"]: row for row in rows}
    assert found["knee reduction"]["elasticity"] == pytest.approx(-0.5)
    assert found["toe.mass"]["elasticity"] == pytest.approx(0.1)
    assert found["hip reduction"]["elasticity"] == pytest.approx(0, abs=1e-9)
    assert rows[0]["parameter"] == "knee reduction"
    assert found["knee reduction"]["effect"] == pytest.approx(1.0, rel=0.1)  # twice
    for row in rows:
        assert row["low"] <= row["elasticity"] <= row["high"]


def test_motors_are_compared_by_their_means():
    sweep = load_sweep("walk_motors")
    table = pd.DataFrame(sweep.samples())
    table["variant"] = "toe"
    table[COST] = np.where(table["actuators.knee.motor"] == "RI80", 0.6, 0.5)
    rows = sensitivities(sweep, table, [COST])
    assert rows[0]["parameter"] == "actuators.knee.motor"
    assert rows[0]["effect"] == pytest.approx(0.2)
    assert rows[0]["elasticity"] is None


def test_a_front_counts_what_is_uncertain(sweep):
    table = power_law(sweep).head(4).copy()
    table[COST] = [0.5, 0.6, 0.501, 0.4]
    table["total_mass"] = [30.0, 29.0, 30.0, 31.0]
    table["walk.arrived"] = [1.0, 1.0, 0.95, 0.0]
    for name, width in ((f"{COST}.low", -0.01), (f"{COST}.high", 0.01)):
        table[name] = table[COST] + width
    found = front(table, [COST, "total_mass"]).set_index("sample")
    assert set(found.index) == {0, 1, 2}  # 3 does not arrive
    assert found.loc[0, "on_front"]
    assert not found.loc[2, "on_front"]
    # 0 and 2 differ by 0.001 with standard errors of 0.0051 each: 2 wins in 45 % of draws
    assert found.loc[2, "front_probability"] == pytest.approx(0.445, abs=0.08)
    assert found.loc[0, "front_probability"] + found.loc[2, "front_probability"] == pytest.approx(1)
    assert found.loc[1, "front_probability"] == 1
    assert best(table, [COST])["sample"].tolist() == [0, 2, 1]


@pytest.mark.parametrize(
    ("share", "heat", "speed", "said"),
    [
        (0.0, 0.5, 0.5, "none"),
        (0.05, 0.5, 0.5, "envelope"),
        (0.05, 1.2, 0.5, "envelope, heat"),
        (0.0, np.nan, 0.97, "speed"),
    ],
)
def test_limits_that_act(share, heat, speed, said):
    part = pd.DataFrame({"limit_share": [share], "thermal_peak": [heat], "speed_use": [speed]})
    assert acting_limits(part) == said


def test_a_table_of_designs_has_the_best_policys_means_intervals_and_reasons(sweep):
    rows = [
        {
            "sample": sample,
            "variant": "toe",
            "protocol": "walk",
            "policy": f"walks-toe-{seed}",
            "trained": "zero-shot",
            "outside": "toe.mass",
            "trial": k,
            "outcome": "arrived",
            "reason": "",
            "cost_of_transport": 0.5 + 0.1 * seed + 0.01 * k,
            "arrived": 1.0,
            "fell": 0.0,
            "limit_share": 0.0,
            "thermal_peak": 0.5,
            "speed_use": 0.5,
        }
        for sample in (0, 1)
        for seed in (0, 1)
        for k in range(4)
    ]
    rows += [rows[0] | {"sample": 2, "trial": -1, "outcome": "rejected", "reason": "too low"}]
    columns = {"sample": np.arange(3), "variant": ["toe"] * 3, "toe.mass": [0.1, 0.2, 0.3]}
    found = design_table(sweep, pd.DataFrame(rows), columns).set_index("sample")
    assert found.loc[1, COST] == pytest.approx(0.51)  # seed 0 is cheaper; trials 0 and 2
    assert found.loc[1, f"{COST}.low"] < 0.51 < found.loc[1, f"{COST}.high"]
    assert found.loc[1, "walk.arrived"] == 1
    assert found.loc[1, "walk.arrived.low"] < 0.5
    assert found.loc[1, "walk.fell"] == 0
    assert found.loc[1, "walk.fell.high"] > 0.5  # two trials say little
    assert found.loc[1, "walk.trials"] == 2
    assert found.loc[1, "walk.policy"] == "walks-toe-0"
    assert found.loc[1, "walk.trained"] == "zero-shot"
    assert found.loc[2, "walk.reason"] == "too low"
    assert np.isnan(found.loc[2, COST])


def test_the_command_builds_the_design_of_the_row():
    sweep = sweep_from_mapping(
        {
            "design": "hyperleg",
            "set": {"pelvis.mass": 14.0},
            "variants": ["toe_removed_matched"],
            "axes": {
                "knee": {"paths": ["transmission.scale.knee"], "scale": [0.5, 2.0]},
                "com": {"paths": ["toe.com"], "scale": [0.9]},
                "actuators.knee.motor": {"values": ["RI80"]},
            },
        }
    )
    samples = sweep.samples()
    row = {name: values[1] for name, values in samples.items()} | {"variant": "toe_removed_matched"}
    words = shlex.split(build_command(sweep, row))
    options = dict(zip(words[2::2], words[3::2], strict=True))
    sets = [value for key, value in zip(words[2::2], words[3::2], strict=True) if key == "--set"]
    built = load_design(options["--design"], overrides=sets, variant=options["--variant"])
    wanted = sweep.design(samples, "toe_removed_matched").take(1)
    for path, value in leaves(wanted).items():
        if isinstance(value, str | bool):
            assert built[path] == value
        else:
            np.testing.assert_allclose(built[path], value, rtol=1e-9, err_msg=path)
    assert built.variant == ablate(sweep.base, "toe_removed_matched").variant


def test_commands_of_a_design_beside_its_sweep_work_from_the_folder_of_the_command(
    tmp_path, monkeypatch
):
    (tmp_path / "r").mkdir()
    (tmp_path / "r" / "mine.yaml").write_text("base: mini_cheetah\n")
    axes = "{links.trunk.mass: {values: [3.0, 4.0]}}"
    (tmp_path / "r" / "sweep.yaml").write_text(f"design: mine.yaml\naxes: {axes}\n")
    monkeypatch.chdir(tmp_path)
    row = {"links.trunk.mass": 4.0, "variant": AS_DESCRIBED}
    sweep = load_sweep("r/sweep.yaml")
    for command in (build_command(sweep, row), view_command(sweep, row)):
        assert " r/mine.yaml --set 'links.trunk.mass=4'" in command


def test_trials_that_fell_say_nothing_of_the_cost_of_walking():
    sweep = sweep_from_mapping(
        {"design": "hyperleg", "evaluate": ["walk"], "axes": {"toe.mass": {"values": [0.1, 0.2]}}}
    )
    trials = pd.DataFrame(
        {
            "sample": [0, 0, 0, 1],
            "variant": "toe",
            "protocol": "walk",
            "policy": "walks-toe-0",
            "trained": "zero-shot",
            "outside": "",
            "outcome": ["arrived", "arrived", "fell", "fell"],
            "fell": [0.0, 0.0, 1.0, 1.0],
            "cost_of_transport": [0.3, 0.4, -2.0, -1.0],
            "limit_share": 0.0,
            "thermal_peak": 0.5,
            "speed_use": 0.5,
        }
    )
    columns = {"sample": [0, 1], "variant": ["toe", "toe"], "toe.mass": [0.1, 0.2]}
    table = design_table(sweep, trials, columns)
    assert table[COST][0] == pytest.approx(0.35)
    assert np.isnan(table[COST][1])
    assert table["walk.fell"].tolist() == pytest.approx([1 / 3, 1.0])


def test_a_design_that_only_stands_does_not_walk(sweep):
    """Five trials each: all arrive, one times out, all time out, and one that was refused."""
    endings = [["arrived"] * 5, ["arrived"] * 4 + ["timed_out"], ["timed_out"] * 5]
    rows = [
        {
            "sample": sample,
            "variant": "toe",
            "protocol": "walk",
            "policy": "walks-toe-0",
            "trained": "zero-shot",
            "outside": "",
            "trial": k,
            "outcome": ending,
            "reason": "",
            "cost_of_transport": 0.5 - 0.1 * sample,  # standing is cheap
            "arrived": float(ending == "arrived"),
            "fell": 0.0,
            "limit_share": 0.0,
            "thermal_peak": 0.5,
            "speed_use": 0.5,
        }
        for sample, own in enumerate(endings)
        for k, ending in enumerate(own)
    ]
    rows += [rows[0] | {"sample": 3, "trial": -1, "outcome": "rejected", "reason": "too low"}]
    columns = {"sample": np.arange(4), "variant": ["toe"] * 4, "toe.mass": [0.1, 0.2, 0.3, 0.4]}
    table = design_table(sweep, pd.DataFrame(rows), columns)
    assert table["walk.fell"].tolist()[:3] == [0, 0, 0]
    assert walks(table).tolist() == [True, False, False, False]
    assert front(table, [COST])["sample"].tolist() == [0]
    assert best(table, [COST])["sample"].tolist() == [0]


def test_a_design_walks_where_it_arrives_under_every_protocol():
    table = pd.DataFrame({"walk.arrived": [1.0, 1.0, 0.9], "t_test.arrived": [0.95, 0.9, 1.0]})
    assert walks(table).tolist() == [True, False, False]


def test_the_committed_map_has_forty_designs_that_walk():
    committed = stored("walk_reduction_and_toe_mass")
    samples = {str(k): v for k, v in committed.sweep.samples().items()}
    columns = {"sample": np.arange(49), "variant": ["toe"] * 49, **samples}
    table = design_table(committed.sweep, committed.trials, columns)
    assert walks(table).sum() == 40
    assert (table["walk.fell"] <= 0.05).sum() == 42
