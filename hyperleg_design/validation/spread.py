"""Jobs spread over processes that start afresh."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import Any

ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Environment of a process whose linear algebra leaves the other processors to its neighbours."""


def spread(
    job: Callable[..., Any], arguments: Sequence[tuple[Any, ...]], workers: int
) -> Iterator[Any]:
    """Run a job for each tuple of arguments.

    Args:
        job: a function that another process can import.
        arguments: of each call.
        workers: processes at the same time; with one, the jobs run in this process, in order.

    Yields:
        Results as they come, of processes of one thread each. After the first error, no further job
        begins.
    """
    if workers <= 1 or len(arguments) < 2:
        for each in arguments:
            yield job(*each)
        return
    for name, value in ONE_THREAD.items():
        os.environ.setdefault(name, value)
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        waiting = [pool.submit(job, *each) for each in arguments]
        try:
            for done in as_completed(waiting):
                yield done.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
