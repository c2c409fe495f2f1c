"""What a log can and cannot show: `hyperleg gap check`."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.checks.declarations import declarations, undeclared_supply
from hyperleg_design.gap.checks.excitation import excitation_of
from hyperleg_design.gap.checks.gates import unusable
from hyperleg_design.gap.checks.plausibility import implausible
from hyperleg_design.gap.checks.rules import RULES
from hyperleg_design.gap.checks.zeros import zeroed
from hyperleg_design.gap.effects.excitation import Excitation
from hyperleg_design.gap.logs.columns import JOINT_SIGNALS, MOTOR_SIGNALS, unit
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.sampling import Column, Sampling, columns_of, sampling_of
from hyperleg_design.gap.model.joint_units import unit_at
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.results.finding import ERROR, NOTE, SEVERITIES, WARNING, Finding
from hyperleg_design.writing import plain

IMU = ("gyro", "accelerometer")
SENSED = ("joint_torque", "motor_torque", "motor_current", "motor_velocity", *IMU)
"""Signals of sensors that never stay as they are."""
BOUNDED = (*SENSED, "motor_torque_command", "velocity")
"""Signals in which a bound that clips is looked for; positions and targets may well rest at one."""
SLOW = ("position_target", "motor_temperature", "battery_voltage", "motor_torque_command")
"""Signals that are often given at lower rates than others."""


@dataclass(frozen=True)
class Check:
    """All that was found in one log."""

    name: str
    sampling: Sampling
    columns: tuple[Column, ...]
    findings: tuple[Finding, ...]
    """What was found, errors first."""
    excitation: tuple[Excitation, ...]
    """Of each effect of the catalogue."""

    @property
    def usable(self) -> bool:
        """Whether nothing forbids a diagnosis."""
        return not self.errors

    @property
    def errors(self) -> tuple[Finding, ...]:
        """Findings that forbid a diagnosis."""
        return tuple(f for f in self.findings if f.severity == ERROR)

    def refuse(self) -> None:
        """Raise the first error there is, for whoever needs a log that is fit.

        Raises:
            InputError: what forbids a diagnosis, with its remedy.
        """
        for finding in self.errors:
            raise InputError(self.name, finding.signal, None, f"{finding.what}; {finding.remedy}")

    def with_findings(self, findings: Sequence[Finding]) -> Check:
        """Copy the check with further findings, in the order of their severity.

        Args:
            findings: to be added.

        Returns:
            The copy.
        """
        every = sorted([*self.findings, *findings], key=lambda f: SEVERITIES.index(f.severity))
        return dataclasses.replace(self, findings=tuple(every))

    @property
    def shown(self) -> tuple[str, ...]:
        """Effects that the log can show."""
        return tuple(e.effect for e in self.excitation if e.shown)

    def column(self, name: str) -> Column:
        """Look up the facts of one column.

        Args:
            name: of the column.

        Returns:
            The facts.
        """
        return next(c for c in self.columns if c.column == name)

    def mapping(self) -> dict[str, Any]:
        """Write the check as plain values, for JSON.

        Returns:
            Nested mappings; numbers that are not finite are None.
        """
        return {
            "name": self.name,
            "usable": self.usable,
            "rate": self.sampling.rate,
            **plain(dataclasses.asdict(self)),
        }


ROBOT = "robot"
"""What findings that are about the model of the robot, not a log, state as their signal."""


def check_log(log: Log, subject: Subject | None = None) -> Check:
    """Check one log for what it can and cannot show.

    Args:
        log: what was read.
        subject: the robot it is said to be of; without it names and ranges of joints are not
            compared.

    Returns:
        Sampling, columns, findings, and what the log can show.
    """
    sampling = sampling_of(log.time)
    columns = tuple(
        dataclasses.replace(column, unit=_unit(column.column, subject))
        for column in columns_of(log)
    )
    refused = unusable(log, subject)
    measured = not any(f.signal == "t" or f.signal.startswith("position/") for f in refused)
    findings = [
        *(Finding(NOTE, "", remark, "") for remark in log.metadata.remarks),
        *(Finding(NOTE, ROBOT, note, "") for note in (subject.notes if subject else ())),
        *refused,
        *_required(log, subject),
        *(_untold(log, subject) if measured and not refused and subject is not None else ()),
        *_clock(sampling),
        *_columns(columns, sampling),
        *(implausible(log, subject) if measured else ()),
        *declarations(log.metadata, subject),
        *undeclared_supply(log),
        *(zeroed(log, subject) if measured and subject is not None else ()),
    ]
    ordered = tuple(sorted(_merged(findings), key=lambda f: SEVERITIES.index(f.severity)))
    return Check(
        log.name, sampling, columns, ordered, excitation_of(log, subject) if measured else ()
    )


def _unit(column: str, subject: Subject | None) -> str:
    """Unit of a column, by the joint or motor that it is of where the robot is known."""
    signal, _, name = column.partition("/")
    own = unit(column)
    if subject is None or signal not in (*JOINT_SIGNALS, *MOTOR_SIGNALS):
        return own
    if signal in JOINT_SIGNALS:
        return unit_at(subject, "joint", name, own)
    aliases = dict(zip(subject.motor_aliases, subject.motors, strict=True))
    return unit_at(subject, "motor", aliases.get(name, name), own)


def _merged(findings: list[Finding]) -> list[Finding]:
    """The findings, with notes that several columns of one signal share as a single one."""
    alike: dict[tuple[str, ...], list[Finding]] = {}
    for finding in findings:
        kind, slash, _ = finding.signal.partition("/")
        key = (
            (kind, finding.what, finding.remedy)
            if finding.severity == NOTE and slash
            else (str(id(finding)),)
        )
        alike.setdefault(key, []).append(finding)
    merged = []
    for finding, *others in alike.values():
        if others:
            finding = dataclasses.replace(
                finding,
                signal=finding.signal.partition("/")[0],
                what=f"{finding.what} ({1 + len(others)} columns)",
            )
        merged.append(finding)
    return merged


def _required(log: Log, subject: Subject | None) -> Iterator[Finding]:
    targets = any(log.has("position_target", j) for j in log.joints)
    torques = any(log.has("joint_torque", j) for j in log.joints) or any(
        log.has(kind, m) for kind in ("motor_torque", "motor_torque_command") for m in log.motors
    )
    currents = any(log.has("motor_current", m) for m in log.motors)
    gains = log.metadata.gains or (subject is not None and np.isfinite(subject.gains).any())
    constants = log.metadata.torque_constant or (
        subject is not None and np.isfinite(subject.torque_constant).any()
    )
    if targets and not gains:
        severity = WARNING if torques or currents else ERROR
        text = "targets without gains say nothing of torques"
        yield Finding(severity, "position_target", text, "declare `gains` in the metadata")
    if currents and not constants:
        severity = WARNING if torques or targets else ERROR
        text = "currents without torque constants say nothing of torques"
        yield Finding(severity, "motor_current", text, "declare `torque_constant`")
    if not targets and not torques and not currents:
        remedy = "log position_target with gains, motor_torque or motor_current"
        yield Finding(ERROR, "", "neither targets nor torques nor currents", remedy)


def _untold(log: Log, subject: Subject) -> Iterator[Finding]:
    """Joints of a log whose torque no signal tells, where it tells that of others."""
    try:
        declared = subject.declare(log.metadata)
    except InputError:  # `declarations` reports it
        return
    steered = {
        joint
        for joint, gains in zip(subject.joints, declared.gains, strict=True)
        if log.has("position_target", joint) and np.isfinite(gains).any()
    }
    known = {joint for joint in subject.joints if log.has("joint_torque", joint)} | steered
    for motor, names in enumerate(zip(subject.motors, subject.motor_aliases, strict=True)):
        kinds = ["motor_torque", "motor_torque_command"]
        if np.isfinite(declared.torque_constant[motor]):
            kinds.append("motor_current")
        if any(log.has(kind, name) for kind in kinds for name in names):
            known |= {subject.joints[i] for i in np.flatnonzero(subject.joint_from_motor[:, motor])}
    untold = [joint for joint in subject.joints if joint in log.joints and joint not in known]
    if known and untold:
        text = f"torque of {', '.join(untold)} is in no signal: faults there show in other joints"
        yield Finding(NOTE, "", text, "log their torques or currents")


def _clock(sampling: Sampling) -> Iterator[Finding]:
    if not RULES.clock.slowest < sampling.rate < RULES.clock.fastest:
        text = (
            f"rows come every {sampling.step:.3g} s: the time looks like "
            f"{'milliseconds' if sampling.rate < 1 else 'another unit'}"
        )
        yield Finding(ERROR, "t", text, "give it in seconds")
        return
    if sampling.duration < RULES.clock.shortest or sampling.ticks < RULES.clock.few:
        text = f"is short: {sampling.duration:.2g} s, {sampling.ticks} ticks"
        remedy = f"record {RULES.clock.shortest:.0f} s or more; 20 s leave enough to hold out"
        yield Finding(WARNING, "t", text, remedy)
    if sampling.rate < RULES.clock.slow:
        text = f"{sampling.rate:.3g} Hz: friction at reversals and delays blur"
        yield Finding(WARNING, "t", text, "log at 100 Hz or more")
    if sampling.jitter > RULES.clock.jitter:
        text = f"the clock jitters by {100 * sampling.jitter:.0f} % of a step"
        yield Finding(NOTE, "t", text, "stamps are used as they are")
    if sampling.dropouts > RULES.clock.dropouts or sampling.longest > 10 * sampling.step:
        text = (
            f"{100 * sampling.dropouts:.1f} % of the time is lost in dropouts, the longest "
            f"{sampling.longest:.3g} s"
        )
        yield Finding(WARNING, "t", text, "the ticks beside them are left out")


def _columns(columns: tuple[Column, ...], sampling: Sampling) -> Iterator[Finding]:
    for column in columns:
        kind = column.column.partition("/")[0]
        if column.missing == 1.0 and kind == "position":
            continue  # `gates` reports it
        if column.missing == 1.0:
            yield Finding(WARNING, column.column, "holds no values", "it counts as missing")
            continue
        if column.missing > RULES.clock.missing:
            text = f"{100 * column.missing:.1f} % of its values are missing"
            yield Finding(WARNING, column.column, text, "the ticks beside them are left out")
        if column.rate < 0.75 * sampling.rate and not column.constant:
            manner = "held" if column.held > 1 else "given"
            text = f"is {manner} at {column.rate:.3g} Hz in a log of {sampling.rate:.3g} Hz"
            severity = NOTE if kind in SLOW else WARNING
            yield Finding(severity, column.column, text, "it counts at its own rate")
        if kind in BOUNDED and column.saturated > RULES.clock.saturated:
            text = (
                f"sits at a bound, {column.low:.4g} or {column.high:.4g}, for "
                f"{100 * column.saturated:.1f} % of the log"
            )
            remedy = "a sensor's range or a drive's limit: effects beyond it do not show"
            yield Finding(WARNING, column.column, text, remedy)
        if column.constant and kind in SENSED:
            text = f"never changes from {column.low:.4g}"
            yield Finding(WARNING, column.column, text, "is the sensor connected?")
