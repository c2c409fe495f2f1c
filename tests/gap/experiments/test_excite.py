import csv

import numpy as np
import pandas
import pytest
import yaml

from hyperleg_design.errors import InputError
from hyperleg_design.gap.experiments import excite as module
from hyperleg_design.gap.experiments import information as info
from hyperleg_design.gap.experiments.designed_experiment import CLEAR
from hyperleg_design.gap.experiments.excite import design_experiment, excite, fixed_subject
from hyperleg_design.gap.experiments.pair import apart
from hyperleg_design.gap.signals.loading import load_subject
from tests.robot.tree_files import leg_file


def test_targets_stay_inside_the_joints_limits_and_start_and_end_gently(made):
    low, high = made.plan.subject.position_low[0], made.plan.subject.position_high[0]
    for motion in made.plan.motions:
        target = motion.target[~motion.off, 0]
        assert target.min() >= low
        assert target.max() <= high
        steps = np.abs(np.diff(target))
        assert steps[:3].max() < 0.1 * max(steps.max(), 0.02)
        assert np.abs(np.diff(target)).max() * 100 < 8


def test_files_hold_the_targets(made):
    for motion in made.plan.motions:
        with open(made.out / f"{motion.name}.csv", newline="") as stream:
            rows = list(csv.DictReader(stream))
        assert len(rows) == len(motion.time)
        assert list(rows[0]) == ["t", "position_target/swing", "drives_on"]
        assert [row["drives_on"] == "0" for row in rows] == motion.off.tolist()
        assert float(rows[7]["position_target/swing"]) == pytest.approx(
            motion.target[7, 0], abs=1e-6
        )
        assert all(
            (row["position_target/swing"] == "") == off
            for row, off in zip(rows, motion.off, strict=True)
        )
        table = pandas.read_parquet(made.out / f"{motion.name}.parquet")
        assert np.allclose(table["position_target/swing"], motion.target[:, 0], equal_nan=True)


def test_shortest_set_tells_all_that_can_be_told_with_nothing_to_spare(made):
    plan = made.plan
    chosen, whole = plan.gram(plan.chosen), plan.gram()
    for place in plan.blocks.places:
        if info.strength(whole, plan.blocks, place) >= CLEAR:
            assert info.strength(chosen, plan.blocks, place) >= CLEAR
    for pair in plan.pairs:
        if apart(whole, plan.blocks, pair) >= CLEAR:
            assert apart(chosen, plan.blocks, pair) >= CLEAR

    def all_told(names):
        gram = plan.gram(names)
        shown = all(
            info.strength(gram, plan.blocks, p) >= CLEAR
            for p in plan.blocks.places
            if info.strength(whole, plan.blocks, p) >= CLEAR
        )
        return shown and all(
            apart(gram, plan.blocks, p) >= CLEAR
            for p in plan.pairs
            if apart(whole, plan.blocks, p) >= CLEAR
        )

    for name in plan.chosen:
        fewer = [n for n in plan.chosen if n != name]
        assert not fewer or not all_told(fewer)


def test_same_seed_gives_the_same_bytes(made, tmp_path):
    excite(made.path, tmp_path, rate=100.0)
    for name in ("chirp.csv", "postures.csv"):
        assert (tmp_path / name).read_bytes() == (made.out / name).read_bytes()


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"rate": 5.0}, "rate"),
        ({"noise": 0.0}, "noise"),
        ({"kinds": "xlsx"}, "format"),
        ({"base": "floating"}, "fixed"),
    ],
)
def test_bad_input_is_refused(made, tmp_path, options, match):
    with pytest.raises(InputError, match=match):
        excite(made.path, tmp_path, **options)


def test_greedy_choice_on_a_made_up_case():
    # three effects of one parameter; motion b shows two of them in half the time, c the third, a
    # only what b shows
    blocks = info.Blocks(
        (("e", "1"), ("e", "2"), ("e", "3")), (0, 2, 4), (("p",),) * 3, (np.ones(1),) * 3
    )

    def shows(*which):
        gram = np.zeros((6, 6))
        for place in which:
            gram[2 * place : 2 * place + 2, 2 * place : 2 * place + 2] = 25.0
        return gram

    grams = {"a": shows(0), "b": shows(0, 1), "c": shows(2)}
    assert module.shortest_set(grams, {"a": 10.0, "b": 5.0, "c": 20.0}, blocks, ()) == ("b", "c")


def test_a_floating_robot_is_put_on_a_rig_where_it_needs_no_pads(tmp_path):
    assert not fixed_subject("hyperleg").floating
    robot = leg_file(trunk={"link": "base", "motion": "floating"}, pads={})
    (tmp_path / "leg.yaml").write_text(yaml.safe_dump(robot))
    held = fixed_subject(str(tmp_path / "leg.yaml"))
    assert not held.floating
    assert held.joints == ("hip", "knee")
    with pytest.raises(InputError, match="base"):
        design_experiment(load_subject("hyperleg"))


def test_joints_that_are_not_named_are_held(robot_files):
    held = fixed_subject(str(robot_files["arm"]), joints=("elbow", "wrist_1"))
    assert held.joints == ("elbow", "wrist_1")
    with pytest.raises(InputError, match="elbow"):
        fixed_subject(str(robot_files["arm"]), joints=("elbow", "ellbow"))
    with pytest.raises(InputError, match="joints"):
        fixed_subject(str(robot_files["arm"]), joints=("nose",))
