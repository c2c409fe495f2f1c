"""Shipped policies: names say group, design and seed, packing keeps what matters and nothing
else.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.evaluation import shipped
from hyperleg_design.evaluation.half_precision import halve_weights
from hyperleg_design.evaluation.policy import load_policy


@pytest.fixture
def campaign(tmp_path, make_onnx):
    """Two finished trainings, one of which has late policies, and one that is at work."""
    content = make_onnx().read_bytes()
    place = tmp_path / "campaign"
    for name, late in (
        ("walk_upright-toe-0", ("late_000800.onnx", "late_000900.onnx")),
        ("t_test-toe_removed_matched-11", ()),
    ):
        folder = place / name
        folder.mkdir(parents=True)
        for file in ("policy.onnx", *late):
            (folder / file).write_bytes(content)
        (folder / "run.json").write_text(json.dumps({"seed": 0}))
        (folder / "checkpoint.pt").write_bytes(b"x" * 10_000)
        rows = [
            {
                "iteration": i,
                "steps": 10 * i,
                "reward": float(i),
                "speed": None,
                "losses": {"value": 1.0},
            }
            for i in range(1, 1001)
        ]
        (folder / "progress.jsonl").write_text(
            "".join(json.dumps(r) + "\n" for r in rows) + '{"iteration": 10'
        )
    (place / "walk_upright-toe-1").mkdir()
    (place / "walk_upright-toe-1" / "checkpoint.pt").write_bytes(b"x")
    (place / "notes").mkdir()
    return place


def test_the_same_policy_twice_is_refused(campaign, tmp_path):
    first = campaign / "walk_upright-toe-0" / "policy.onnx"
    other = tmp_path / "other.onnx"
    other.write_bytes(first.read_bytes() + b"x")
    shipped.check_different([first, other])
    with pytest.raises(InputError, match="same policy as walk_upright-toe-0/policy"):
        shipped.check_different(
            [first, other, campaign / "walk_upright-toe-0" / "late_000800.onnx"]
        )


def test_policies_are_listed_by_group_design_seed_and_lateness(campaign):
    found = shipped.shipped_policies(campaign)
    assert [(p.group, p.design, p.seed, p.late, p.path.name) for p in found] == [
        ("t_test", "toe_removed_matched", 11, 0, "policy.onnx"),
        ("walk_upright", "toe", 0, 0, "policy.onnx"),
        ("walk_upright", "toe", 0, 1, "late_000900.onnx"),
        ("walk_upright", "toe", 0, 2, "late_000800.onnx"),
    ]
    assert found[0].training == "t_test-toe_removed_matched-11"
    assert found[1].name == load_policy(found[1].path).name
    assert len(shipped.shipped_policies(campaign, late=False)) == 2


def test_a_packed_campaign_has_the_same_policies_and_little_else(campaign, tmp_path):
    found = shipped.pack(campaign, tmp_path / "packed")
    assert [(p.training, p.policies) for p in found] == [
        ("t_test-toe_removed_matched-11", 1),
        ("walk_upright-toe-0", 3),
        ("walk_upright-toe-1", 0),
    ]
    folder = tmp_path / "packed" / "walk_upright-toe-0"
    names = {p.name for p in folder.iterdir()}
    assert names == {
        ".hyperleg",
        "policy.onnx",
        "late_000800.onnx",
        "late_000900.onnx",
        "run.json",
        "progress.jsonl",
    }
    assert (folder / "policy.onnx").read_bytes() == halve_weights(
        (campaign / "walk_upright-toe-0" / "policy.onnx").read_bytes()
    )
    assert found[1].size == sum(p.stat().st_size for p in folder.iterdir())
    before, after = (shipped.shipped_policies(p) for p in (campaign, tmp_path / "packed"))
    assert [(p.training, p.late) for p in before] == [(p.training, p.late) for p in after]
    assert "walk_upright-toe-1" in shipped.pack_text(found)
    assert "2 of 3 trainings, 4 policies" in shipped.pack_text(found)
    assert shipped.pack(campaign, tmp_path / "packed") == found  # again, over itself


def test_of_a_group_the_last_policy_alone_is_packed_or_nothing(campaign, tmp_path):
    ship = {"walk_upright": "last", "t_test": "none"}
    found = shipped.pack(campaign, tmp_path / "packed", ship)
    assert (found[0].training, found[0].policies) == ("walk_upright-toe-0", 1)
    assert not (tmp_path / "packed" / "t_test-toe_removed_matched-11").exists()
    assert not list((tmp_path / "packed" / "walk_upright-toe-0").glob("late_*"))
    assert (tmp_path / "packed" / "walk_upright-toe-0" / "run.json").exists()


@pytest.mark.parametrize(("ship", "critic"), [("last", True), ("policy", False)])
def test_a_policy_is_packed_with_its_critic_or_alone(campaign, tmp_path, ship, critic):
    own = campaign / "walk_upright-toe-0"
    (own / "critic.onnx").write_bytes((own / "policy.onnx").read_bytes())
    shipped.pack(campaign, tmp_path / "packed", {"walk_upright": ship, "t_test": "none"})
    assert (tmp_path / "packed" / own.name / "policy.onnx").exists()
    assert (tmp_path / "packed" / own.name / "critic.onnx").exists() is critic


def test_a_learning_curve_is_thinned_by_means(campaign):
    rows = shipped.learning_curve(campaign / "walk_upright-toe-0")
    assert len(rows) == shipped.CURVE_ROWS
    assert rows[-1]["steps"] == 10_000
    assert rows[0]["reward"] == pytest.approx(3.0)  # of 1 .. 5
    assert np.mean([r["reward"] for r in rows]) == pytest.approx(500.5)
    assert set(rows[0]) == {"steps", "reward"}
    assert shipped.learning_curve(campaign / "walk_upright-toe-1") == []


def test_a_training_of_a_name_is_found(campaign, tmp_path, monkeypatch):
    monkeypatch.setattr(shipped, "shipped_folder", lambda: campaign)
    assert (
        shipped.find_policy("walk_upright-toe-0") == campaign / "walk_upright-toe-0" / "policy.onnx"
    )
    assert load_policy("walk_upright-toe-0").seed == 3
    with pytest.raises(
        InputError,
        match=r"walk_upright-toe-7.*did you mean walk_upright-toe-0\? Shipped, with their seeds: "
        r"t_test-toe_removed_matched-11, walk_upright-toe-0$",
    ):
        shipped.find_policy("walk_upright-toe-7")


def test_seeds_of_a_name_are_told_together():
    names = ["walk-a-1", "walk-a-0", "walk-a-2", "walk-b-0", "walk-b-2", "walk-b-3", "walk-c-4"]
    assert shipped.trainings_text(names) == "walk-a-0..2, walk-b-0, walk-b-2..3, walk-c-4"
    assert shipped.trainings_text([]) == ""


def test_no_shipped_policy_is_no_error_but_a_wrong_folder_is(tmp_path, monkeypatch):
    monkeypatch.setattr(shipped, "shipped_folder", lambda: tmp_path / "nothing")
    assert shipped.shipped_policies() == []
    with pytest.raises(InputError, match="no such folder"):
        shipped.shipped_policies(tmp_path / "nothing")


def test_the_folder_of_one_training_is_not_taken_for_one_that_holds_trainings(campaign):
    with pytest.raises(InputError, match="is the folder of one training"):
        shipped.shipped_policies(campaign / "walk_upright-toe-0")


def test_nothing_foreign_is_packed_or_overwritten(campaign, tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        shipped.pack(tmp_path / "nothing", tmp_path / "packed")
    with pytest.raises(InputError, match="holds no training"):
        shipped.pack(campaign / "walk_upright-toe-0", tmp_path / "packed")
    mine = tmp_path / "packed" / "walk_upright-toe-0"
    mine.mkdir(parents=True)
    (mine / "thesis.txt").write_text("mine")
    with pytest.raises(OutputError):
        shipped.pack(campaign, tmp_path / "packed")
    assert [p.name for p in mine.iterdir()] == ["thesis.txt"]


def test_trainings_of_other_robots_say_so(campaign):
    (one,) = [
        p for p in shipped.shipped_policies(campaign, late=False) if p.group == "walk_upright"
    ]
    assert one.family == "hyperleg"
    found = json.loads((one.path.parent / "run.json").read_text())
    (one.path.parent / "run.json").write_text(json.dumps({**found, "design": {"family": "tree"}}))
    assert one.family == "tree"


def test_a_folder_of_a_training_is_its_policy_or_says_that_it_is_not_finished(tmp_path):
    folder = tmp_path / "training"
    folder.mkdir()
    (folder / "run.json").write_text("{}")
    for name in (folder, folder / "policy.onnx"):
        with pytest.raises(InputError, match=r"--policy = .*the training is not finished"):
            shipped.find_policy(name, "--policy")
    (folder / "policy.onnx").write_bytes(b"onnx")
    for name in (folder, folder / "policy.onnx"):
        assert shipped.find_policy(name) == folder / "policy.onnx"
