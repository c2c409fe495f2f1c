"""From files to what measuring and diagnosing work on: logs opened, checked, joined with their
robot, and conditioned.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.checks.check import Check, check_log
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
    """Nominal model of the robot under test."""
    tests: tuple[Signals, ...]
    """Logs to be diagnosed."""
    references: tuple[Signals, ...]
    """Logs of the healthy robot."""
    checks: tuple[Check, ...]
    """Of all logs, those under test first."""


def take_in(
    robot: str,
    sources: Sequence[str | os.PathLike[str]],
    references: Sequence[str | os.PathLike[str]] = (),
    *,
    reference_robot: str = "",
) -> Intake:
    """Open, check and condition logs.

    Args:
        robot: a design of ours, or an MJCF or URDF file; empty: what the logs name.
        sources: files or folders of any known format; logs whose metadata say so count as
            references.
        references: of the healthy robot.
        reference_robot: see `prepare`; empty: the same.

    Returns:
        The robot, and the signals of all logs.

    Raises:
        InputError: a log that cannot be opened, or see `prepare`.
    """
    if not sources:
        raise InputError("gap", "logs", None, "expects files or folders of logs")
    logs, healthy = (
        [log for source in names for log in open_log(source)] for names in (sources, references)
    )
    return prepare(robot or None, logs, healthy, reference_robot=reference_robot or None)


def prepare(
    robot: str | Path | None,
    logs: Sequence[Log],
    references: Sequence[Log] = (),
    *,
    reference_robot: str | Path | None = None,
) -> Intake:
    """Check and condition logs.

    Args:
        robot: a design of ours, or an MJCF or URDF file; none: what the logs name.
        logs: to be diagnosed; those whose metadata call them references count as such.
        references: of the same robot when all was well.
        reference_robot: nominal model of the robot in the reference logs, where it was built
            differently then; by default the same as now. Joints and motors must be the same.

    Returns:
        The robot, and the signals of all logs.

    Raises:
        InputError: no log to test, the same one twice, a log that is not fit, or a robot that does
            not go with its logs.
    """
    for first, second in itertools.combinations([*logs, *references], 2):
        if _same(first, second):
            remedy = f"holds the same as {first.name}; each recording counts once"
            raise InputError("gap", "logs", second.name, remedy)
    tests = [log for log in logs if log.metadata.role != REFERENCE]
    well = [*(log for log in logs if log.metadata.role == REFERENCE), *references]
    healthy = [log.changed(metadata=replace(log.metadata, role=REFERENCE)) for log in well]
    if not tests:
        remedy = "are all references: name at least one log to be diagnosed"
        if not healthy:
            remedy = "are missing: give at least one log to be diagnosed"
        raise InputError("gap", "logs", len(healthy), remedy)
    subject, before = _subjects(robot, reference_robot, tests, healthy)
    checks = (
        *(check_log(log, subject) for log in tests),
        *(check_log(log, before) for log in healthy),
    )
    for check in checks:
        check.refuse()
    return Intake(
        subject,
        tuple(condition(log, subject) for log in tests),
        tuple(condition(log, before) for log in healthy),
        checks,
    )


def _subjects(
    robot: str | Path | None,
    reference_robot: str | Path | None,
    tests: Sequence[Log],
    references: Sequence[Log],
) -> tuple[Subject, Subject]:
    """Nominal models of the robot in the tests and in the references; the same object where there
    is one model.
    """
    if not reference_robot:
        subject = load_subject(robot, [*tests, *references])
        return subject, subject
    if not references:
        remedy = "needs reference logs: name them with --reference"
        raise InputError("diagnose", "reference_robot", str(reference_robot), remedy)
    subject, before = load_subject(robot, tests), load_subject(reference_robot, references)
    for what in ("joints", "motors"):
        now, then = getattr(subject, what), getattr(before, what)
        if now != then:
            remedy = (
                f"has other {what} than {subject.name}: {', '.join(then)}, not {', '.join(now)}"
            )
            raise InputError("diagnose", "reference_robot", str(reference_robot), remedy)
    return subject, before


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
