from __future__ import annotations

import os
import signal
from concurrent.futures import ThreadPoolExecutor

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.sweep import run as running
from hyperleg_design.sweep.jobs import cluster, completed
from hyperleg_design.sweep.run import run_sweep
from hyperleg_design.sweep.space import sweep_from_mapping

SWEEP = {
    "design": "hyperleg",
    "sampling": "sobol",
    "count": 256,
    "measures": ["total_mass", "swing_inertia", "push_off_heat"],
    "axes": {"toe.mass": {"low": 0.1, "high": 0.5}, "thigh.length": {"low": 0.3, "high": 0.4}},
}


def test_each_result_comes_once_wherever_it_is_made():
    jobs = [(i, (i, 2)) for i in range(20)]
    with ThreadPoolExecutor(3) as executor:
        beside = sorted(completed(pow, jobs, executor))
    assert beside == list(completed(pow, jobs)) == [(i, i**2) for i in range(20)]


def test_without_an_address_jobs_stay_here():
    with cluster("") as executor:
        assert executor is None


def test_a_scheduler_that_is_not_there_is_one_clear_error(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("hyperleg_design.sweep.jobs.CONNECT", 0.5)
    for address in ("tcp://127.0.0.1:1", "nonsense://x"):
        with pytest.raises(InputError, match=r"--scheduler.*does not answer"), cluster(address):
            pass


def test_a_scheduler_without_workers_is_one_clear_error():
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=0, processes=False, dashboard_address=None, protocol="tcp"
        ) as local,
        pytest.raises(InputError, match="no workers"),
        cluster(local.scheduler_address),
    ):
        pass


def test_a_scheduler_gives_the_same_table(tmp_path):
    distributed = pytest.importorskip("distributed")
    sweep = sweep_from_mapping(SWEEP)
    alone = run_sweep(sweep, tmp_path / "alone", chunk=64, progress=False)
    with (
        distributed.LocalCluster(
            n_workers=2, processes=False, dashboard_address=None, protocol="tcp"
        ) as local,
        cluster(local.scheduler_address) as executor,
    ):
        beside = run_sweep(sweep, tmp_path / "beside", chunk=64, progress=False, executor=executor)
    assert beside.table_path.read_bytes() == alone.table_path.read_bytes()


@pytest.mark.slow
def test_a_worker_that_is_killed_loses_and_doubles_nothing(tmp_path, monkeypatch):
    """A real scheduler with worker processes, one of them killed after the first result."""
    distributed = pytest.importorskip("distributed")
    sweep = sweep_from_mapping(SWEEP | {"count": 4096})
    alone = run_sweep(sweep, tmp_path / "alone", chunk=128, progress=False)
    written, whole = [], running.write_bytes
    with (
        distributed.LocalCluster(
            n_workers=3, threads_per_worker=1, processes=True, dashboard_address=None
        ) as local,
        cluster(local.scheduler_address) as executor,
    ):

        def write(path, content):
            written.append(path)
            if len(written) == 1:
                victim = next(iter(local.workers.values()))
                os.kill(victim.pid, signal.SIGKILL)
            return whole(path, content)

        monkeypatch.setattr(running, "write_bytes", write)
        beside = run_sweep(sweep, tmp_path / "beside", chunk=128, progress=False, executor=executor)
    assert len(written) == len(set(written)) == 32
    assert beside.table_path.read_bytes() == alone.table_path.read_bytes()


def test_what_is_no_address_is_one_clear_error():
    with (
        pytest.raises(InputError, match=r"--scheduler = 'nonsense'.*tcp://host:8786"),
        cluster("nonsense"),
    ):
        pass
