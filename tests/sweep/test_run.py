import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor

import numpy as np
import pytest
import yaml

from hyperleg_design import provenance, resources
from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.sweep import run, table
from hyperleg_design.sweep.measuring import evaluate
from hyperleg_design.sweep.run import CHUNKS, STATE, run_sweep
from hyperleg_design.sweep.space import sweep_from_mapping

DEFINITION = {
    "name": "little",
    "design": "hyperleg",
    "variants": ["toe", "toe_removed_matched"],
    "sampling": "sobol",
    "count": 60,
    "seed": 7,
    "axes": {
        "foot.ball_length": {"low": 0.1, "high": 0.6},
        "actuators.knee.motor": {"values": ["RI60", "RI70"]},
        "legs": {"paths": ["thigh.length", "shank.length"], "scale": {"low": 0.8, "high": 1.2}},
    },
    "measures": ["total_mass", "swing_inertia", "push_off_heat"],
    "objectives": ["swing_inertia", "push_off_heat"],
}


@pytest.fixture(autouse=True)
def _steady_commit(monkeypatch):
    """Whatever happens to the checkout while tests run."""
    monkeypatch.setattr(provenance, "git_commit", lambda: "abc")


def sweep(**change):
    return sweep_from_mapping(DEFINITION | change)


def go(folder, definition=None, **options):
    return run_sweep(definition or sweep(), folder, progress=False, **options)


@pytest.fixture
def whole(tmp_path):
    return go(tmp_path / "whole").table_path.read_bytes()


def test_the_table_holds_every_design_and_what_made_it(tmp_path):
    result = go(tmp_path / "out")
    columns = result.columns()
    assert len(columns["sample"]) == 120
    assert (
        columns["foot.ball_length"].tobytes()
        == np.repeat(sweep().samples()["foot.ball_length"], 2).tobytes()
    )
    made = table.read_metadata(result.table_path)
    assert made["sweep"] == json.loads(json.dumps(sweep().to_mapping()))
    assert made["sweep"]["seed"] == 7
    assert made["sweep"]["design"]["toe"]["mass"]["value"] == 0.22
    assert made["commit"] == "abc"
    assert made["versions"]["numpy"] == np.__version__
    assert sorted(p.name for p in result.folder.iterdir()) == [
        ".hyperleg",
        "designs.parquet",
        "summary.json",
    ]
    assert json.loads((result.folder / "summary.json").read_text()) == result.summary


def test_the_same_seed_gives_the_same_bytes_whatever_the_chunks(tmp_path, whole):
    for chunk in (1, 7, 32, 1000):
        assert go(tmp_path / str(chunk), chunk=chunk).table_path.read_bytes() == whole
    assert go(tmp_path / "seed", sweep(seed=8)).table_path.read_bytes() != whole


def test_row_groups_do_not_follow_the_chunks(tmp_path, monkeypatch):
    monkeypatch.setattr(table, "ROW_GROUP", 50)
    files = [go(tmp_path / str(chunk), chunk=chunk).table_path for chunk in (9, 60)]
    assert files[0].read_bytes() == files[1].read_bytes()
    assert table.rows_of(files[0]) == 120


def test_an_executor_gives_the_same_table(tmp_path, whole):
    with ThreadPoolExecutor(2) as executor:
        assert go(tmp_path / "threads", chunk=7, executor=executor).table_path.read_bytes() == whole


class _Failing(Executor):
    """Evaluates two chunks, then breaks, as a lost worker does."""

    def __init__(self):
        self.left = 2

    def submit(self, function, /, *arguments, **options):
        future = Future()
        self.left -= 1
        if self.left >= 0:
            future.set_result(function(*arguments, **options))
        else:
            future.set_exception(RuntimeError("worker lost"))
        return future


def test_an_interrupted_run_evaluates_only_what_is_missing(tmp_path, whole, monkeypatch):
    folder = tmp_path / "out"
    with pytest.raises(RuntimeError, match="worker lost"):
        go(folder, chunk=10, executor=_Failing())
    assert len(list((folder / CHUNKS).glob("*.parquet"))) == 2
    assert not (folder / "designs.parquet").exists()
    evaluated = []
    original = evaluate.evaluate_range
    monkeypatch.setattr(run, "evaluate_range", lambda *a: evaluated.append(a[1:3]) or original(*a))
    result = go(folder, chunk=60)  # a resumed run keeps its chunks
    assert evaluated == [(20, 30), (30, 40), (40, 50), (50, 60)]
    assert result.table_path.read_bytes() == whole
    assert not (folder / CHUNKS).exists()


def test_a_damaged_chunk_is_evaluated_again(tmp_path, whole):
    folder = tmp_path / "out"
    with pytest.raises(RuntimeError, match="worker lost"):
        go(folder, chunk=10, executor=_Failing())
    first, second = sorted((folder / CHUNKS).glob("*.parquet"))
    first.write_bytes(b"not a table")
    shutil.copy(second, folder / CHUNKS / "00000030-00000031.parquet")  # of no chunk of this run
    assert go(folder).table_path.read_bytes() == whole


def test_a_finished_run_is_returned_not_repeated(tmp_path, monkeypatch):
    first = go(tmp_path / "out")
    before = first.table_path.stat().st_mtime_ns
    monkeypatch.setattr(run, "evaluate_range", None)
    again = go(tmp_path / "out")
    assert again.summary == first.summary
    assert again.table_path.stat().st_mtime_ns == before


def test_a_changed_definition_is_refused_or_restarted(tmp_path):
    folder = tmp_path / "out"
    go(folder)
    before = (folder / "designs.parquet").read_bytes()
    with pytest.raises(OutputError, match=r"sweep little with another definition.*--restart"):
        go(folder, sweep(seed=8))
    assert (folder / "designs.parquet").read_bytes() == before
    assert go(folder, sweep(seed=8), resume=False).summary["seed"] == 8


def test_a_changed_definition_of_a_stopped_run_is_refused_or_restarted(tmp_path):
    folder = tmp_path / "out"
    with pytest.raises(RuntimeError, match="worker lost"):
        go(folder, chunk=10, executor=_Failing())
    with pytest.raises(OutputError, match="another definition"):
        go(folder, sweep(count=50))
    assert len(list((folder / CHUNKS).glob("*.parquet"))) == 2
    go(folder, sweep(count=50), resume=False)


def test_another_version_of_the_code_is_refused(tmp_path, monkeypatch):
    go(tmp_path / "out")
    monkeypatch.setattr(provenance, "git_commit", lambda: "def")
    with pytest.raises(OutputError, match="another version of the code"):
        go(tmp_path / "out")


def test_somebody_elses_folder_is_left_alone(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "thesis.tex").write_text("mine")
    for resume in (True, False):
        with pytest.raises(OutputError, match="did not write"):
            go(folder, resume=resume)
    assert [p.name for p in folder.iterdir()] == ["thesis.tex"]


def test_another_result_of_ours_is_left_alone(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / ".hyperleg").write_text("")
    (folder / "robot.urdf").write_text("<robot/>")
    with pytest.raises(OutputError, match="no sweep"):
        go(folder, resume=False)
    assert (folder / "robot.urdf").exists()


def test_a_damaged_store_is_made_again_or_says_so(tmp_path):
    folder = tmp_path / "out"
    result = go(folder)
    whole = result.table_path.read_bytes()
    result.table_path.write_bytes(whole[:300])
    assert go(folder).table_path.read_bytes() == whole
    (folder / "summary.json").write_text("garbage")
    with pytest.raises(OutputError, match=r"summary.json is damaged.*--restart"):
        go(folder)
    assert go(folder, resume=False).table_path.read_bytes() == whole


def test_a_wrong_definition_writes_nothing(tmp_path):
    path = tmp_path / "wrong.yaml"
    path.write_text(yaml.safe_dump(DEFINITION | {"axes": {"toe.mas": {"values": [1]}}}))
    with pytest.raises(InputError, match=r"wrong\.yaml: axes\.toe\.mas.*did you mean toe\.mass"):
        run_sweep(path, tmp_path / "out", progress=False)
    with pytest.raises(InputError, match="chunk"):
        go(tmp_path / "out", chunk=0)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("limit", [300, 9000])
def test_a_full_disk_is_one_clear_error_and_nothing_half_written(tmp_path, whole, limit):
    """Files longer than the limit cannot be written: at first not even the state, then not the
    joined table.
    """
    folder = tmp_path / "out"
    old = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, old[1]))
        with pytest.raises(OutputError, match="cannot be written") as caught:
            go(folder, chunk=10)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
        signal.signal(signal.SIGXFSZ, ignored)
    assert "\n" not in str(caught.value)
    assert not (folder / "designs.parquet").exists()
    assert not (folder / "summary.json").exists()
    assert all(table.rows_of(p) == 20 for p in (folder / CHUNKS).glob("*.parquet"))
    left = {p.name for p in tmp_path.rglob("*") if p.is_file() and p.suffix != ".parquet"}
    assert left <= {".hyperleg", "summary.json", STATE}, left
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out", "whole"]
    assert go(folder).table_path.read_bytes() == whole


SCRIPT = """
import sys, time
from hyperleg_design.sweep import run
original = run.evaluate_range
def slow(*arguments):
    time.sleep(float(sys.argv[3]))
    return original(*arguments)
run.evaluate_range = slow
run.run_sweep(sys.argv[1], sys.argv[2], chunk=10, progress=False)
"""


def test_a_killed_run_goes_on_and_ends_with_the_same_bytes(tmp_path):
    """SIGKILL in mid-run, then again, then to the end; content lies outside a checkout, so no
    commit changes.
    """
    home = tmp_path / "home"
    for kind in ("descriptions", "motors", "sweeps"):
        shutil.copytree(resources.content_folder(kind), home / kind)
    path, folder = tmp_path / "little.yaml", tmp_path / "out"
    path.write_text(yaml.safe_dump(DEFINITION))
    environment = os.environ | {"HYPERLEG_HOME": str(home)}

    def start(out, pause):
        return subprocess.Popen(
            [sys.executable, "-c", SCRIPT, str(path), str(out), str(pause)], env=environment
        )

    for wanted in (1, 3):
        process = start(folder, 0.25)
        deadline = time.monotonic() + 60
        while (
            len(list((folder / CHUNKS).glob("0*.parquet"))) < wanted and time.monotonic() < deadline
        ):
            time.sleep(0.02)
        process.send_signal(signal.SIGKILL)
        assert process.wait() == -signal.SIGKILL
        assert (folder / CHUNKS / STATE).is_file()
        assert not (folder / "designs.parquet").exists()
    assert start(folder, 0).wait() == 0
    assert start(tmp_path / "whole", 0).wait() == 0
    for name in ("designs.parquet", "summary.json"):
        assert (folder / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_a_bar_shows_progress(tmp_path, capsys, monkeypatch):
    original = run.evaluate_range
    monkeypatch.setattr(run, "evaluate_range", lambda *a: time.sleep(0.2) or original(*a))
    run_sweep(sweep(), tmp_path / "out", chunk=10)
    shown = capsys.readouterr()
    assert "little: 100%" in shown.err
    assert "120/120" in shown.err
    assert shown.out == ""
