import json

import pytest

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.gap.logs.log import read_log
from hyperleg_design.validation.blind.score import open_key, score
from hyperleg_design.validation.blind.trial import diagnose_trial, make_trial, read_seal

SEED, SHORT = 0, (2.0, 2.4)


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    folder = tmp_path_factory.mktemp("blind") / "trial"
    seal = make_trial(2, SEED, folder, plants=("rig",), duration=SHORT)
    assert seal == read_seal(folder)
    return folder


def knows_nothing(robot, logs, reference, *, threads):
    assert logs
    assert threads == 1
    return {
        "schema": 1,
        "verdict": "unknown",
        "causes": [],
        "rivals": [],
        "equivalent": [],
        "seen": [str(robot), len(logs), len(reference)],
    }


def breaks_down(robot, logs, reference, *, threads):
    raise ValueError("out of order")


@pytest.mark.slow
def test_cases_hold_logs_and_no_truth(trial):
    truths = open_key(trial)
    assert [t["case"] for t in truths] == ["000", "001"]
    for truth in truths:
        folder = trial / "cases" / truth["case"]
        entry = json.loads((folder / "case.json").read_text())
        logs = [read_log(folder / p) for p in entry["logs"]]
        assert len(logs) == 3
        assert all(log.metadata.role == "test" for log in logs)
        assert all(read_log(folder / p).metadata.role == "reference" for p in entry["references"])
        assert bool(entry["references"]) == truth["references"]
        assert (folder / entry["robot"]).is_file() == (truth["robot"] in ("arm", "servo"))
        content = b"".join(p.read_bytes() for p in folder.rglob("*") if p.is_file())
        assert not any(w["effect"].encode() in content for w in truth["wrongs"])
    assert not (trial / ".making").exists()


@pytest.mark.slow
def test_effects_show_about_as_planned(trial):
    for truth in open_key(trial):
        for wrong in truth["wrongs"]:
            assert 0.2 < wrong["multiple"] / wrong["wanted"] < 5.0


@pytest.mark.slow
@pytest.mark.slow
def test_the_same_seed_makes_the_same_trial(trial, tmp_path):
    again = make_trial(2, SEED, tmp_path / "again", plants=("rig",), duration=SHORT, workers=2)
    assert again.sha256 == read_seal(trial).sha256
    for path in sorted((trial / "cases").rglob("*.parquet")):
        other = read_log(tmp_path / "again" / path.relative_to(trial))
        log = read_log(path)
        assert all((log.signals[c] == other.signals[c]).all() for c in log.signals)


@pytest.mark.slow
def test_a_finished_trial_is_not_made_again_and_another_is_refused(trial):
    before = (trial / "key.zip").stat().st_mtime_ns
    make_trial(2, SEED, trial, plants=("rig",), duration=SHORT)
    assert (trial / "key.zip").stat().st_mtime_ns == before
    with pytest.raises(OutputError, match="another trial"):
        make_trial(3, SEED, trial, plants=("rig",), duration=SHORT)


@pytest.mark.slow
def test_diagnoses_go_on_where_they_stopped(trial):
    assert diagnose_trial(trial, diagnose=knows_nothing) == 2
    (trial / "diagnoses" / "001" / "seconds.json").unlink()
    assert diagnose_trial(trial, diagnose=breaks_down) == 1
    assert diagnose_trial(trial, diagnose=breaks_down) == 0
    assert (
        json.loads((trial / "diagnoses" / "001" / "diagnosis.json").read_text())["verdict"]
        == "error"
    )
    found = score(trial)
    assert found.diagnosed == 2
    assert found.row("diagnoses that raised an error").value == 0.5
    assert "SHA-256" in found.markdown()


def test_bad_orders(tmp_path):
    with pytest.raises(InputError, match="at least one"):
        make_trial(0, 0, tmp_path / "x")
    with pytest.raises(InputError, match="choose of"):
        make_trial(1, 0, tmp_path / "x", plants=("moon",))
    (tmp_path / "foreign").mkdir()
    (tmp_path / "foreign" / "thesis.txt").write_text("mine")
    with pytest.raises(OutputError, match="hyperleg did not write"):
        make_trial(1, 0, tmp_path / "foreign", plants=("rig",))
