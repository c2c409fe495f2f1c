"""Processes side by side: never too many, all of them, and none left after an error."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from hyperleg_design import processes
from hyperleg_design.processes import run_side_by_side


@pytest.fixture(autouse=True)
def fast(monkeypatch):
    monkeypatch.setattr(processes, "POLL", 0.01)


def python(script, *words):
    return subprocess.Popen([sys.executable, "-c", script, *map(str, words)])


def test_every_job_runs_in_order_and_never_more_than_the_workers():
    running, most, started, codes = set(), [], [], {}

    def start(job):
        started.append(job)
        running.add(job)
        most.append(len(running))
        return python("import sys; sys.exit(int(sys.argv[1]))", job)

    def ended(job, code):
        running.remove(job)
        codes[job] = code

    run_side_by_side(range(5), start, workers=2, ended=ended)
    assert started == [0, 1, 2, 3, 4]
    assert max(most) == 2
    assert codes == {0: 0, 1: 1, 2: 2, 3: 3, 4: 4}


def test_a_job_waits_for_what_it_needs_and_is_left_out_if_that_never_comes(tmp_path: Path):
    """The second needs the first's file, the third one that nobody writes."""
    done = []
    run_side_by_side(
        [(2, 1), (3, 9), (1, None)],
        lambda job: python("import sys; open(sys.argv[1], 'w').close()", tmp_path / str(job[0])),
        workers=3,
        ready=lambda job: job[1] is None or (tmp_path / str(job[1])).exists(),
        ended=lambda job, code: done.append((job[0], code)),
    )
    assert done == [(1, 0), (2, 0)]


def test_it_is_watched_at_the_end_too_even_without_jobs():
    looks = []
    run_side_by_side([], python, workers=1, watch=lambda: looks.append(1))
    assert looks == [1]


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_an_error_stops_what_runs(error):
    started = []

    def start(job):
        started.append(python("import time; time.sleep(60)"))
        return started[-1]

    def watch():
        raise error

    with pytest.raises(error):
        run_side_by_side("ab", start, workers=2, watch=watch)
    assert [process.poll() for process in started] == [-signal.SIGTERM] * 2
