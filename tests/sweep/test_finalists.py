from __future__ import annotations

import json

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.report.sweep.search_text import final_text
from hyperleg_design.sweep import finalists
from hyperleg_design.sweep.finalists import (
    chosen_finalists,
    final_protocol,
    run_finalists,
    winners,
)
from hyperleg_design.sweep.search import Search, run_search, search_of
from hyperleg_design.sweep.space import sweep_from_mapping
from hyperleg_design.sweep.trials.trial_plan import plan
from hyperleg_design.sweep.tunings.fine_tuning import FineTuning

optuna = pytest.importorskip("optuna")

SPACE = {
    "design": "hyperleg",
    "sampling": "sobol",
    "count": 1,
    "measures": ["total_mass", "push_off_heat"],
    "axes": {"toe.mass": {"low": 0.1, "high": 0.6}},
}
SHORT = WalkProtocol(trials=2, distance=0.6, time_limit=0.8, steady=Steady(begin=0.3))


def drawn(objectives, rows, constraints=("total_mass<=100",)) -> tuple[Search, optuna.Study]:
    """A study whose trials measured given values."""
    sweep = sweep_from_mapping(SPACE)
    search = search_of(sweep, plan(sweep, []), objectives, constraints)
    study = optuna.create_study(directions=search.directions)
    for i, row in enumerate(rows):
        trial = study.ask()
        trial.set_user_attr("row", {"sample": i, "variant": "toe", "toe.mass": 0.2, **row})
        study.tell(trial, [row[name] for name in search.objectives])
    return search, study


def test_finalists_are_the_front_and_then_the_next_one():
    masses = [5.0, 1.0, 3.0, 2.0, 200.0]
    search, study = drawn(["total_mass"], [{"total_mass": m} for m in masses])
    assert [row["sample"] for row in chosen_finalists(search, study, 3)] == [1, 3, 2]
    assert [row["sample"] for row in chosen_finalists(search, study, 9)] == [1, 3, 2, 0]


def test_a_large_front_is_thinned_evenly():
    rows = [{"total_mass": float(i), "push_off_heat": 20.0 - i} for i in range(9)]
    search, study = drawn(["total_mass", "push_off_heat"], rows)
    assert [row["sample"] for row in chosen_finalists(search, study, 3)] == [0, 4, 8]
    assert [row["sample"] for row in chosen_finalists(search, study, 1)] == [0]


def test_winners_hold_the_constraints_and_nothing_beats_them():
    search, _ = drawn(["total_mass", "push_off_heat"], [])
    rows = [
        {"sample": i, "total_mass": mass, "push_off_heat": heat}
        for i, (mass, heat) in enumerate([(3.0, 1.0), (2.0, 2.0), (2.5, 2.5), (1.0, None)])
    ]
    assert winners(search, rows) == (1, 0)
    assert winners(search, [dict(row, total_mass=101.0) for row in rows]) == ()


def test_the_final_protocol_has_fresh_seeds_and_more_trials():
    final = final_protocol(SHORT)
    assert final.trials == 6
    assert final.seed != SHORT.seed
    assert (final.distance, final.steady) == (SHORT.distance, SHORT.steady)
    assert final_protocol(SHORT.changed(trials=4096, seed=2**31 - 1)).trials == 4096


def test_a_search_without_trials_has_nothing_to_evaluate_again(tmp_path):
    search, study = drawn(["total_mass"], [{"total_mass": m} for m in (3.0, 2.0)])
    final = run_finalists(search, study, tmp_path, progress=False)
    assert final.winners == (1,)
    assert all(f.before == f.searched and f.after is None for f in final.finalists)
    with pytest.raises(InputError, match=r"--finetune.*--evaluate"):
        run_finalists(search, study, tmp_path, steps=100, progress=False)


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """A search whose designs walk."""
    sweep = sweep_from_mapping(SPACE)
    search = search_of(sweep, plan(sweep, [SHORT], seeds=1), ["walk.power"], ["walk.fell<=1"])
    folder = tmp_path_factory.mktemp("search")
    return search, run_search(search, folder, 4, batch=4, progress=False)


def test_new_trials_decide(walked, tmp_path):
    """Each finalist's values are those of `evaluate` under the final protocol."""
    search, study = walked
    final = run_finalists(search, study, tmp_path, count=2, progress=False)
    assert len(final.finalists) == 2
    for finalist in final.finalists:
        design = search.sweep.base.with_values({"toe.mass": finalist.searched["toe.mass"]})
        alone = evaluate("walk_upright-toe-0", final_protocol(SHORT), design=design)
        stood = alone.values("fell") == 0
        assert finalist.before["walk.power"] == alone.values("power")[stood].mean()
        assert finalist.before["walk.trials"] == 6
        assert finalist.before["walk.power"] != finalist.searched["walk.power"]
        assert finalist.before["total_mass"] == finalist.searched["total_mass"]
    best = min(final.finalists, key=lambda f: f.before["walk.power"])
    assert final.winners[0] == best.number
    text = final_text(search, final)
    assert f"winner: design {best.number}, by the values of new trials" in text
    assert "--finetune" in text
    written = json.loads((tmp_path / "finalists" / "finalists.json").read_text())
    assert written == json.loads(json.dumps(final.to_mapping()))


def test_fine_tuned_policies_decide(walked, tmp_path, monkeypatch):
    """What the trainings give is what runs; here, other shipped policies stand in for them."""
    from hyperleg_design.evaluation.shipped import find_policy

    search, study = walked
    jobs: list[FineTuning] = []
    monkeypatch.setattr(finalists, "check_fine_tuning", lambda search: None)
    monkeypatch.setattr(finalists, "fine_tune", lambda found, **_: jobs.extend(found))
    monkeypatch.setattr(FineTuning, "result", find_policy("walk_upright-toe-2"))
    final = run_finalists(search, study, tmp_path, count=2, steps=500, progress=False)
    assert {job.steps for job in jobs} == {500}
    assert [job.folder.name for job in jobs] == [str(f.number) for f in final.finalists]
    for job, finalist in zip(jobs, final.finalists, strict=True):
        assert job.design["toe.mass"] == finalist.searched["toe.mass"]
        alone = evaluate("walk_upright-toe-2", final_protocol(SHORT), design=job.design)
        stood = alone.values("fell") == 0
        assert finalist.after is not None
        assert finalist.after["walk.power"] == alone.values("power")[stood].mean()
    best = min(final.finalists, key=lambda f: f.after["walk.power"])
    assert final.winners[0] == best.number
    assert "by the values after fine-tuning" in final_text(search, final)
