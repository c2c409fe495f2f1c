"""From files to what measuring and diagnosing work on: logs opened, checked, joined with their
robot, and conditioned.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.checks.check import check_log
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.readers import open_log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.signals import Signals

REFERENCE = "reference"
"""Role of a log of the healthy robot."""


@dataclass(frozen=True, eq=False)
class Intake:
    """Logs ready to be compared with a robot."""

    subject: Subject
    tests: tuple[Signals, ...]
    references: tuple[Signals, ...]


def take_in(
    robot: str,
    sources: Sequence[str | os.PathLike[str]],
    references: Sequence[str | os.PathLike[str]] = (),
) -> Intake:
    """Open, check and condition logs.

    Args:
        robot: a design of ours, or an MJCF or URDF file; empty: what the logs name.
        sources: files or folders of any known format; logs whose metadata say so count as
            references.
        references: of the healthy robot.

    Returns:
        The robot, and the signals of all logs.

    Raises:
        InputError: no log to test, a log that cannot be opened or is not fit, a robot that does not
        go with the logs.
    """
    tests, healthy = open_logs(sources, references)
    subject = load_subject(robot or None, [*tests, *healthy])
    for log in (*tests, *healthy):
        check_log(log, subject).refuse()
    ready = (tuple(condition(log, subject) for log in logs) for logs in (tests, healthy))
    return Intake(subject, *ready)


def open_logs(
    sources: Sequence[str | os.PathLike[str]], references: Sequence[str | os.PathLike[str]] = ()
) -> tuple[list[Log], list[Log]]:
    """Open the logs to be tested and those of the healthy robot.

    Args:
        sources: files or folders; logs whose metadata say so count as references.
        references: files or folders of the healthy robot.

    Returns:
        The logs to be tested, and the references.

    Raises:
        InputError: no log to test, one that cannot be opened, or the same one twice.
    """
    if not sources:
        raise InputError("gap", "logs", None, "expects files or folders of logs")
    opened = [
        (log, log.metadata.role == REFERENCE) for source in sources for log in open_log(source)
    ]
    opened += [(log, True) for source in references for log in open_log(source)]
    for (first, _), (second, _) in itertools.combinations(opened, 2):
        if _same(first, second):
            remedy = f"holds the same as {first.name}; each recording counts once"
            raise InputError("gap", "logs", second.name, remedy)
    tests = [log for log, reference in opened if not reference]
    healthy = [log for log, reference in opened if reference]
    if not tests:
        raise InputError(
            "gap", "logs", len(healthy), "are all references: name at least one log to be diagnosed"
        )
    return tests, healthy


def _same(first: Log, second: Log) -> bool:
    """Whether two logs are one recording."""
    return (
        np.array_equal(first.time, second.time)
        and first.signals.keys() == second.signals.keys()
        and all(
            np.array_equal(values, second.signals[column], equal_nan=True)
            for column, values in first.signals.items()
        )
    )
