from __future__ import annotations

import os
import re
import shutil
import socket
import subprocess
from pathlib import Path

import pandas as pd
import pytest

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.report.sweep.search_text import final_text
from hyperleg_design.sweep import search as searching
from hyperleg_design.sweep.finalists import run_finalists
from hyperleg_design.sweep.measuring import measures
from hyperleg_design.sweep.search import found_designs, run_search, search_of
from hyperleg_design.sweep.searching.constraint import earlier_constraints
from hyperleg_design.sweep.space import sweep_from_mapping
from hyperleg_design.sweep.trials.trial_plan import plan
from hyperleg_design.writing import MARKER

optuna = pytest.importorskip("optuna")

SPACE = {
    "design": "hyperleg",
    "sampling": "sobol",
    "count": 1,
    "seed": 3,
    "measures": ["total_mass", "push_off_heat", "push_off_use"],
    "objectives": ["total_mass", "push_off_heat"],
    "axes": {
        "toe.mass": {"low": 0.05, "high": 1.0, "log": True},
        "knee": {"paths": ["transmission.scale.knee"], "scale": {"low": 0.5, "high": 2.0}},
        "actuators.knee.motor": {"values": ["RI60", "RI70"]},
    },
}


def small(**changes):
    sweep = sweep_from_mapping(SPACE | changes)
    return search_of(sweep, plan(sweep, []), constraints=["push_off_use<=1.5"])


def trial_frame(study):
    """A row for each trial: number, state, reason of failure, and what was measured."""
    return pd.DataFrame(
        [
            {
                "number": trial.number,
                "state": trial.state.name.lower(),
                "reason": trial.user_attrs.get(searching.REASON, ""),
                **trial.user_attrs.get(searching.ROW, {}),
            }
            for trial in study.get_trials(deepcopy=False)
        ]
    )


def test_the_front_holds_the_constraints_and_nothing_beats_it(tmp_path):
    search = small()
    study = run_search(search, tmp_path, 24, batch=8, progress=False)
    rows = trial_frame(study)
    assert len(rows) == 24
    assert set(rows["state"]) <= {"complete", "fail"}
    front = found_designs(search, study)
    assert front
    feasible = rows[(rows["state"] == "complete") & (rows["push_off_use"] <= 1.5)]
    for row in front:
        assert row["push_off_use"] <= 1.5
        better = (feasible["total_mass"] < row["total_mass"]) & (
            feasible["push_off_heat"] < row["push_off_heat"]
        )
        assert not better.any()
        base = search.sweep.base
        made = base.with_values(
            {
                "toe.mass": row["toe.mass"],
                "transmission.scale.knee": row["knee"] * base.transmission.scale.knee,
                "actuators.knee.motor": row["actuators.knee.motor"],
            }
        )
        own = measures.evaluate(made, ["total_mass", "push_off_heat"])
        assert row["push_off_heat"] == pytest.approx(own["push_off_heat"][0], rel=1e-9)


def test_two_bounds_of_one_measure_both_hold(tmp_path):
    sweep = sweep_from_mapping(SPACE)
    bounds = ["total_mass>=32.5", "total_mass<=99", "total_mass>=0"]
    search = search_of(sweep, plan(sweep, []), constraints=bounds)
    study = run_search(search, tmp_path, 8, progress=False)
    masses = trial_frame(study)["total_mass"]
    assert {row["total_mass"] for row in found_designs(search, study)} <= set(
        masses[masses >= 32.5]
    )
    assert masses.min() < 32.5


def test_an_impossible_corner_fails_and_says_why(tmp_path):
    """A foot as long as the leg."""
    axes = SPACE["axes"] | {"foot.ball_length": {"low": 0.4, "high": 0.6}}
    study = run_search(
        small(axes=axes, set={"thigh.length": 0.2}), tmp_path, 12, batch=6, progress=False
    )
    failed = trial_frame(study).query("state == 'fail'")
    assert len(failed)
    assert (failed["reason"] != "").all()
    assert failed["reason"].str.contains("foot.ball_length").any()


def test_a_killed_search_goes_on_and_counts_nothing_twice(tmp_path, monkeypatch):
    whole, calls = searching._tell, []

    def stopped(*arguments):
        calls.append(arguments)
        if len(calls) == 7:
            raise KeyboardInterrupt
        whole(*arguments)

    monkeypatch.setattr(searching, "_tell", stopped)
    with pytest.raises(KeyboardInterrupt):
        run_search(small(), tmp_path, 12, batch=4, progress=False)
    study = run_search(small(), tmp_path, 12, batch=4, progress=False)
    rows = trial_frame(study)
    finished = rows[rows["state"].isin(["complete", "fail"])]
    assert len(finished) == 12
    lost = rows[rows["state"] == "pruned"]
    assert len(lost) == 2  # of the batch in flight, asked for again
    axes = ["toe.mass", "knee"]
    again = {tuple(t.params[a] for a in axes) for t in study.trials if t.number > lost.index.max()}
    assert {tuple(study.trials[n].params[a] for a in axes) for n in lost["number"]} <= again
    assert run_search(small(), tmp_path, 12, progress=False).trials == study.trials


def test_a_database_holds_one_search_under_a_name(tmp_path):
    run_search(small(), tmp_path, 1, progress=False)
    for other in (small(seed=4), small(objectives=["total_mass"])):
        with pytest.raises(OutputError, match="choose another --name"):
            run_search(other, tmp_path, 1, progress=False)
    run_search(small(seed=4), tmp_path, 1, name="other", progress=False)


def test_a_database_that_refuses_or_is_corrupt_is_one_clear_error(tmp_path):
    url = "postgresql+psycopg://me:secret@127.0.0.1:1/none"
    with pytest.raises(InputError, match=r"--storage.*does not serve") as caught:
        run_search(small(), tmp_path, 1, storage=url, progress=False)
    assert "secret" not in str(caught.value)
    (tmp_path / MARKER).touch()
    (tmp_path / "study.db").write_bytes(b"no database at all" * 100)
    with pytest.raises(InputError, match="does not serve"):
        run_search(small(), tmp_path, 1, progress=False)


def test_a_foreign_folder_is_left_alone_and_an_older_search_goes_on(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(OutputError, match="did not write"):
        run_search(small(), tmp_path, 1, progress=False)
    assert [entry.name for entry in tmp_path.iterdir()] == ["notes.txt"]
    (tmp_path / MARKER).touch()
    with pytest.raises(OutputError, match="is no search"):
        run_search(small(), tmp_path, 1, progress=False)
    run_search(small(), tmp_path / "out", 1, progress=False)
    (tmp_path / "out" / MARKER).unlink()
    assert len(run_search(small(), tmp_path / "out", 2, progress=False).trials) == 2


def test_a_folder_that_cannot_be_made_and_a_measure_that_is_not_there(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"is a file.*--out"):
        run_search(small(), tmp_path / "file" / "out", 1, progress=False)
    sweep = sweep_from_mapping(SPACE)
    with pytest.raises(InputError, match=r"did you mean max_joint_torque\.knee"):
        search_of(sweep, plan(sweep, []), ["max_joint_torque.kne"])


def test_designs_are_walked(tmp_path):
    protocol = WalkProtocol(trials=2, distance=0.6, time_limit=0.8, steady=Steady(begin=0.3))
    sweep = sweep_from_mapping(SPACE | {"axes": {"toe.mass": {"low": 0.1, "high": 0.5}}})
    search = search_of(sweep, plan(sweep, [protocol], seeds=1), ["walk.power", "total_mass"])
    study = run_search(search, tmp_path, 3, batch=3, progress=False)
    rows = trial_frame(study)
    assert set(rows["walk.trained"]) == {"zero-shot"}
    told = {t.number: t.values[0] for t in study.trials if t.values}
    for number, power in told.items():
        assert power == rows.set_index("number").loc[number, "walk.power"]
    assert all("walk.thermal_peak" in t.constraints for t in study.trials)


def test_a_search_with_the_earlier_bounds_goes_on_by_the_options_that_the_error_names(
    tmp_path, monkeypatch
):
    protocol = WalkProtocol(trials=2, distance=0.6, time_limit=0.8, steady=Steady(begin=0.3))
    sweep = sweep_from_mapping(SPACE | {"axes": {"toe.mass": {"low": 0.1, "high": 0.5}}})
    wanted = plan(sweep, [protocol], seeds=1)
    with monkeypatch.context() as patch:
        patch.setattr(searching, "usual_constraints", earlier_constraints)
        begun = search_of(sweep, wanted, ["walk.power"])
    assert begun.constraints[0].text == "walk.fell<=0.05"
    run_search(begun, tmp_path, 1, progress=False)
    with pytest.raises(OutputError, match="on falls rather than arrivals") as caught:
        run_search(search_of(sweep, wanted, ["walk.power"]), tmp_path, 1, progress=False)
    bounds = re.findall(r"--constraint '(\S+)'", str(caught.value))
    same = search_of(sweep, wanted, ["walk.power"], bounds)
    assert len(run_search(same, tmp_path, 1, progress=False).trials) == 1


def test_designs_of_a_quadruped_are_walked_and_its_finalist_walks_again(tmp_path):
    protocol = WalkProtocol(trials=2, distance=0.6, time_limit=1.2, steady=Steady(begin=0.3))
    axes = {"actuators.knee.gear": {"low": 5.0, "high": 9.0}}
    sweep = sweep_from_mapping(
        {"design": "mini_cheetah", "sampling": "sobol", "count": 1, "axes": axes}
    )
    search = search_of(sweep, plan(sweep, [protocol]), ["walk.power"], ["walk.fell<=1"])
    study = run_search(search, tmp_path, 2, progress=False)
    assert trial_frame(study)["walk.trained"].tolist() == ["zero-shot"] * 2
    final = run_finalists(search, study, tmp_path, count=1, progress=False)
    (finalist,) = final.finalists
    assert finalist.before["walk.trials"] == 6
    assert f"--set 'actuators.knee.gear={finalist.before['actuators.knee.gear']:.10g}'" in (
        final_text(search, final)
    )


def _postgres() -> Path | None:
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"))
    return found[-1].parent if found else None


@pytest.fixture
def postgres(tmp_path):
    """URL of a database of a PostgreSQL server of its own, on a free local port."""
    pytest.importorskip("psycopg")
    programs = _postgres()
    if programs is None:
        pytest.skip("PostgreSQL is not installed (Debian: postgresql)")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    folder = tmp_path / "server"
    folder.mkdir()
    user: list[str] = []
    if os.geteuid() == 0:  # PostgreSQL refuses to run as root
        if shutil.which("setpriv") is None:
            pytest.skip("setpriv is not there to start PostgreSQL as another user than root")
        user = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]
        os.chown(folder, 65534, 65534)
        for part in (*folder.parents,):
            if str(part).startswith(str(tmp_path.parents[1])):
                part.chmod(part.stat().st_mode | 0o011)
    data = str(folder / "data")

    def run(*words):
        done = subprocess.run([*user, *words], capture_output=True, text=True, cwd="/")
        if done.returncode:
            pytest.skip(f"PostgreSQL does not start here: {done.stderr.strip()[-200:]}")

    run(f"{programs}/initdb", "-D", data, "-U", "me", "-A", "trust", "--no-sync")
    options = f"-p {port} -k {folder} -c listen_addresses=127.0.0.1 -c fsync=off"
    run(f"{programs}/pg_ctl", "-D", data, "-w", "-l", f"{folder}/log", "-o", options, "start")
    yield f"postgresql+psycopg://me@127.0.0.1:{port}/postgres"
    run(f"{programs}/pg_ctl", "-D", data, "-m", "immediate", "stop")


def test_two_searches_share_a_study_in_postgresql(postgres, tmp_path):
    search = small()
    run_search(search, tmp_path / "one", 5, storage=postgres, batch=5, progress=False)
    study = run_search(search, tmp_path / "two", 9, storage=postgres, batch=4, progress=False)
    rows = trial_frame(study)
    assert len(rows) == 9
    owners = [t.user_attrs["owner"] for t in study.trials]
    assert sorted(map(owners.count, set(owners))) == [4, 5]
