"""Processes that run side by side until all are done, and stop together."""

from __future__ import annotations

import itertools
import signal
import subprocess
import time
from collections.abc import Callable, Iterable
from typing import TypeVar

Job = TypeVar("Job")

POLL = 0.5
"""Time between looks at the processes [s]."""


def run_side_by_side(
    jobs: Iterable[Job],
    start: Callable[[Job], subprocess.Popen[bytes]],
    *,
    workers: int,
    ready: Callable[[Job], bool] = lambda job: True,
    ended: Callable[[Job, int], object] = lambda job, code: None,
    watch: Callable[[], object] = lambda: None,
) -> None:
    """Run jobs as processes, at most some at the same time, in their order as far as they are
    ready.

    When this process is interrupted or an error occurs, the processes that still run are asked to
    stop (SIGTERM) and waited for.

    Args:
        jobs: what to run.
        start: starts the process of a job.
        workers: most processes at the same time.
        ready: whether a job can start now; those that never can, once nothing runs any more, are
            left out.
        ended: takes each job whose process has ended, and its exit code.
        watch: called at every look at the processes, and at the end.
    """
    waiting, running = list(jobs), list[tuple[Job, subprocess.Popen[bytes]]]()
    try:
        while True:
            for pair in [pair for pair in running if pair[1].poll() is not None]:
                running.remove(pair)
                ended(pair[0], pair[1].returncode)
            free = workers - len(running)
            for job in list(itertools.islice(filter(ready, waiting), free)):
                waiting.remove(job)
                running.append((job, start(job)))
            watch()
            if not running:
                break
            time.sleep(POLL)
    finally:
        for _, process in running:
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
        for _, process in running:
            process.wait()
