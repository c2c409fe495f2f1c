"""Jobs of a sweep or search, run here or on other machines; each result is given once."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager
from typing import Any, TypeVar

from hyperleg_design.errors import InputError

Job = TypeVar("Job")
Result = TypeVar("Result")

AHEAD = 2
"""Jobs a worker that wait at the executor, so that no worker waits for this process."""
CONNECT = 10.0
"""Time within which a scheduler must answer [s]."""


def completed(
    function: Callable[..., Result],
    jobs: Iterable[tuple[Job, tuple[Any, ...]]],
    executor: Executor | None = None,
) -> Iterator[tuple[Job, Result]]:
    """Results of jobs as they are done, each once.

    Args:
        function: of a job's arguments.
        jobs: what each is known by, and its arguments.
        executor: where they run; one after the other in this process by default.

    Returns:
        Pairs of job and result, in the order in which they are done.
    """
    if executor is None:
        for job, arguments in jobs:
            yield job, function(*arguments)
        return
    rest = iter(jobs)
    running: dict[Future[Result], Job] = {}
    most = AHEAD * workers_of(executor)
    try:
        while True:
            while len(running) < most and (item := next(rest, None)) is not None:
                running[executor.submit(function, *item[1])] = item[0]
            if not running:
                return
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                yield running.pop(future), future.result()
    finally:
        for future in running:
            future.cancel()


def workers_of(executor: Executor) -> int:
    """Count the jobs that an executor runs at a time.

    Args:
        executor: of `concurrent.futures` or Dask.

    Returns:
        The count, at least 1.
    """
    client = getattr(executor, "_client", None)
    if client is not None:
        return max(1, sum(client.nthreads().values()))
    return int(getattr(executor, "_max_workers", 1))


@contextmanager
def cluster(address: str) -> Iterator[Executor | None]:
    """Connect to the workers of a Dask scheduler; without an address, use this process.

    A job whose worker dies is run again on another one. Each result is asked for once, by the
    process that holds the store, so none is lost or counted twice.

    Args:
        address: such as `tcp://host:8786`.

    Yields:
        The executor; None without an address.

    Raises:
        InputError: the extra `cluster` is not installed, nothing answers at the address, or the
            scheduler has no workers.
    """
    if not address:
        yield None
        return
    if not re.fullmatch(r"[a-z]+://\S+", address):
        raise InputError("--scheduler", "", address, "expects an address such as tcp://host:8786")
    try:
        import distributed
    except ImportError:
        raise InputError(
            "--scheduler", "", address, "needs hyperleg-design[cluster] (dask.distributed)"
        ) from None
    try:
        client: Any = distributed.Client(address, timeout=CONNECT, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            "--scheduler", "", address, f"does not answer ({type(error).__name__}); is it running?"
        ) from None
    try:
        if not client.nthreads():
            raise InputError(
                "--scheduler", "", address, "has no workers; start some with `dask worker`"
            )
        yield client.get_executor(pure=False)
    finally:
        client.close()
