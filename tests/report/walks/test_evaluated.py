"""Shipped policies are each run under the protocol of their task, and what is missing is known."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.protocol import Steady, TTestProtocol, WalkProtocol
from hyperleg_design.report.walks.evaluated import T_TEST, WALK, evaluate_shipped

SHORT = {
    "walk": WalkProtocol(trials=2, distance=2.0, time_limit=1.6, steady=Steady(begin=0.5)),
    "t_test": TTestProtocol(trials=2, time_limit=15.0),
}


@pytest.fixture(scope="module")
def evaluated(trainings):
    seen = []
    found = evaluate_shipped(
        trainings, **SHORT, band=(0.01, 0.02), workers=1, progress=lambda *a: seen.append(a)
    )
    return found, seen


def test_each_policy_has_the_protocol_of_its_task(evaluated):
    found, _ = evaluated
    assert found.groups(WALK) == ["walk_upright"]
    assert found.groups(T_TEST) == ["t_test"]
    assert found.designs("walk_upright") == ["toe", "toe_removed_matched"]
    assert found.seeds("walk_upright", "toe") == [0, 1]
    assert [e.protocol.name for e in found.of("t_test", "toe")] == ["t_test"]
    assert all(set(e.outcomes) <= {"fell", "timed_out"} for e in found.evaluations)


def test_signals_are_kept_of_one_trial_of_each_design(evaluated):
    found, _ = evaluated
    kept = {
        (p.training): len(e.trials) for p, e in zip(found.policies, found.evaluations, strict=True)
    }
    assert kept == {
        "t_test-toe-0": 1,
        "walk_upright-toe-0": 1,
        "walk_upright-toe-1": 0,
        "walk_upright-toe_removed_matched-0": 1,
    }
    assert found.shown("walk_upright", "toe").design.variant == "toe"


def test_progress_counts_everything(evaluated):
    found, seen = evaluated
    assert [done for done, _, _ in seen] == list(range(1, 4 + 3 * 2 + 1))
    assert {count for _, count, _ in seen} == {10}
    assert sorted(found.band) == ["toe", "toe_removed_matched"]
    assert [len(found.band["toe"][c]) for c in (0.01, 0.02)] == [2, 1 + 1]


def test_the_band_changes_the_contact_and_nothing_else(evaluated):
    found, _ = evaluated
    stiff, own = (found.band["toe"][c][0] for c in (0.01, 0.02))
    assert np.array_equal(
        own.values("distance"), found.of("walk_upright", "toe")[0].values("distance")
    )
    assert not np.array_equal(stiff.values("distance"), own.values("distance"))


def test_rows_carry_design_and_seed_of_the_folder(evaluated):
    table = evaluated[0].table("walk_upright")
    assert table.groupby(["variant", "seed"]).size().to_dict() == {
        ("toe", 0): 2,
        ("toe", 1): 2,
        ("toe_removed_matched", 0): 2,
    }


def test_missing_trainings_are_those_of_the_study(evaluated):
    missing = evaluated[0].missing
    assert "walk_upright-toe-0" not in missing
    assert {
        "walk_upright-toe-2",
        "walk_upright-toe_locked-0",
        "walk_upright-toe_removed_matched-7",
        "t_test_free-toe-0",
        "t_test_free-toe_locked-4",
    } <= set(missing)
    groups = {name.split("-")[0] for name in missing}
    assert groups == {"walk_upright", "t_test_free"}  # others only start from the guided ones


def test_an_empty_folder_gives_nothing_and_a_wrong_one_is_told(tmp_path):
    found = evaluate_shipped(tmp_path)
    assert (found.policies, found.evaluations, found.band) == ([], [], {})
    assert len(found.missing) > 30
    with pytest.raises(InputError, match="no such folder"):
        evaluate_shipped(tmp_path / "nothing")
