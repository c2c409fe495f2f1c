from __future__ import annotations

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.report.sizing import comparison
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot
from tests.robot.tree_files import leg


@pytest.fixture(scope="module")
def design():
    return load_design("hyperleg")


def test_table_one_agrees_but_for_the_speeds(design):
    rows = comparison.table_one(design)
    assert len(rows) == 4 + 3 * 7
    for row in rows:
        assert row.verdict == ("differs" if row.quantity.endswith("speed") else "agrees"), row
    assert all(row.note for row in rows if row.verdict == "differs")


def test_a_wrong_design_is_seen(design):
    rows = comparison.table_one(design.with_values({"actuators.knee.gear": 8.0}))
    wrong = {r.quantity for r in rows if r.verdict == "differs"}
    assert {"knee torque, derated", "knee reduction, standing"} <= wrong


def test_power_constants_differ_by_the_vendors_torque_constant():
    rows = {r.quantity: r for r in comparison.motor_rows()}
    assert rows["RI70 Cp"].ours == pytest.approx(24.7, abs=0.05)
    assert rows["RI60 Cp"].difference == pytest.approx(90.0 / 124.57 - 1, abs=1e-3)


def test_compare_puts_designs_beside_each_other(design):
    found = comparison.compare([design, load_design("toe_removed")])
    assert list(found) == ["hyperleg", "toe_removed"]
    assert (
        found["toe_removed"]["max_joint_torque"]["knee"]
        < found["hyperleg"]["max_joint_torque"]["knee"]
    )
    text, others = comparison.compare_text(found).split("\n\n")
    assert "toe_removed" in text.splitlines()[0]
    units = {line.split()[0]: line.split()[1] for line in text.splitlines()[2:]}
    assert (units["total_mass"], units["torque_alone.knee"]) == ("kg", "Nm")
    assert units["zonotope_to_box_volume"] == "-"
    (toe,) = (line.split() for line in others.splitlines()[3:])
    assert toe[:2] == ["toe", "hyperleg"]
    limits = [found["hyperleg"][name]["toe"] for name in comparison.JOINTWISE]
    assert [float(cell) for cell in toe[2:]] == pytest.approx(limits, rel=1e-3)


def test_rows_of_one_measure_stand_together_and_no_joint_has_an_empty_cell():
    robots = [load_robot(name) for name in ("teaching_leg", "mini_cheetah", "parallel_ankle")]
    measures = comparison.compare(robots)
    text, others = comparison.compare_text(measures).split("\n\n")
    groups = [line.split(".")[0] for line in text.splitlines()[2:] if "." in line.split()[0]]
    runs = [group for group, other in zip(groups, ["", *groups], strict=False) if group != other]
    assert len(runs) == len(set(runs))
    common = {line.split()[0] for line in text.splitlines() if line.startswith("torque_alone.")}
    assert common == {"torque_alone.knee"}
    apart = [tuple(line.split()[:2]) for line in others.splitlines()[3:]]
    joints = [(j, name) for name, entry in measures.items() for j in entry["torque_alone"]]
    assert sorted(apart) == sorted(pair for pair in joints if pair[0] != "knee")


def test_compare_keeps_two_designs_of_one_name_apart(design):
    assert len(comparison.compare([design, design.with_values({"toe.mass": 0.4})])) == 2


def test_a_quadruped_is_walked_beside_a_biped(monkeypatch):
    short = WalkProtocol(trials=2, distance=0.6, time_limit=0.8, steady=Steady(begin=0.3))
    monkeypatch.setattr("hyperleg_design.evaluation.evaluate.load_protocol", lambda name: short)
    designs = [load_robot("mini_cheetah"), load_design("toe")]
    found = comparison.compare_walks(designs, ["walk"], seeds=1, workers=1)["walk"]
    assert [entry["policy"] for entry in found] == ["specialist"] * 2
    with pytest.raises(InputError, match=r"swap lock_toe.*mini_cheetah.*is no HyperLeg"):
        comparison.compare_walks(designs[:1], ["walk"], workers=1, swap="lock_toe")


def test_designs_are_walked_by_the_policies_of_their_toe_layout(monkeypatch):
    short = WalkProtocol(trials=2, distance=0.6, time_limit=0.8, steady=Steady(begin=0.3))
    monkeypatch.setattr("hyperleg_design.evaluation.evaluate.load_protocol", lambda name: short)
    designs = [load_design("toe", overrides={"toe.mass": 0.6}), load_design("toe_locked")]
    found = comparison.compare_walks(designs, ["walk"], seeds=1, workers=1)["walk"]
    assert [set(entry) for entry in found] == [{"policy", *comparison.MEASURED["walk"]}] * 2
    assert "toe.mass" in found[0]["policy"]
    assert "toe.mass" not in found[1]["policy"]
    for entry in found:
        assert entry["fell"]["low"] <= entry["fell"]["mean"] <= entry["fell"]["high"]


def test_a_robot_described_as_a_whole_has_no_mass_of_a_leg_and_without_pads_no_height():
    whole = leg(pads={}, trunk={"link": "base", "motion": "floating"})
    (entry,) = comparison.compare([whole]).values()
    assert (entry["leg_mass"], entry["standing_height"]) == ("", "")
