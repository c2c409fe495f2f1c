"""Whether positions follow their targets."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from hyperleg_design.gap.checks.rules import RULES
from hyperleg_design.gap.checks.slopes import DEGREES, fitted_correlations, fitted_slopes
from hyperleg_design.gap.checks.torque_plausibility import asked_torque
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.results.finding import ERROR, WARNING, Finding


def implausible_targets(log: Log, subject: Subject | None) -> Iterator[Finding]:
    """Find positions that do not follow their targets: units, signs, swapped joints, late clocks.

    Args:
        log: the log.
        subject: the robot; without it, the torques that could explain a position are not known.

    Returns:
        The findings.
    """
    joints = [j for j in log.joints if log.has("position_target", j)]
    if not joints:
        return
    position, target = log.stack("position", joints), log.stack("position_target", joints)
    lag = _common_lag(log, position, target)
    if lag:
        position, target = position[lag:], target[:-lag]
    _, fit = fitted_slopes(position, target)
    for i, joint in enumerate(joints):
        column = f"position_target/{joint}"
        if not np.isfinite(fit[i]) or np.nanstd(target[:, i]) < 1e-3:
            continue
        ratio = float(np.nanstd(target[:, i]) / max(np.nanstd(position[:, i]), 1e-12))
        rivals = fitted_correlations(position, target[:, i])
        rivals[i] = -1
        best = int(np.nanargmax(rivals)) if np.isfinite(rivals).any() else i
        if (
            abs(fit[i]) < RULES.unit.strange
            and rivals[best] > RULES.unit.fits
            and fitted_correlations(target, position[:, i])[best] > RULES.unit.fits
        ):
            text = (
                f"is followed by {joints[best]} (correlation {rivals[best]:.2f}), not by "
                f"{joint} ({fit[i]:.2f})"
            )
            yield Finding(ERROR, column, text, "the columns of two joints are swapped: rename them")
        elif fit[i] < -RULES.unit.fits and ratio < 10 and not _pushed(log, subject, joint):
            # what stands on the ground, and whose torques nobody logged, may be pushed against its
            # targets
            severity = WARNING if log.metadata.base == "floating" else ERROR
            yield Finding(
                severity, column, "runs against its position", "flip the sign of one of the two"
            )
        elif fit[i] > RULES.unit.strange and (
            abs(ratio / DEGREES - 1) < 0.4 or abs(ratio * DEGREES - 1) < 0.4
        ):
            # a soft joint may follow its target as little; then neither turns as far as degrees
            # would say
            severity = (
                ERROR
                if max(np.nanmax(np.abs(target[:, i])), np.nanmax(np.abs(position[:, i])))
                > RULES.unit.half_turn
                else WARNING
            )
            text = (
                f"moves {ratio:.3g} times as far as its position: one of the two "
                f"{'is' if severity == ERROR else 'may be'} in degrees"
            )
            yield Finding(severity, column, text, "convert both to rad")


def _pushed(log: Log, subject: Subject | None, joint: str) -> bool:
    """Whether torques at a joint are those that its target asks for, so that it is a load that
    moves it the other way.
    """
    motors = {joint}
    if subject is not None and joint in subject.joints:
        turned = subject.motor_from_joint[:, subject.joints.index(joint)] != 0
        motors |= {motor for motor, here in zip(subject.motors, turned, strict=True) if here}
    held = [
        (asked, torque)
        for column, asked, torque in asked_torque(log, subject)
        if column.partition("/")[2] in motors
    ]
    return any(
        fitted_slopes(asked[:, None], torque[:, None])[1][0] > RULES.unit.strange
        for asked, torque in held
    )


def _common_lag(log: Log, position: np.ndarray, target: np.ndarray) -> int:
    """Rows by which positions follow targets, up to half a second, the same for all joints,
    whichever follows which.
    """
    limit = min(round(0.5 / log.step), len(position) // 4)
    stride = max(1, len(position) // 4000)

    def unit(values: np.ndarray) -> np.ndarray:
        values = np.nan_to_num(values - np.nanmean(values, 0))
        return np.asarray(values / np.maximum(np.linalg.norm(values, axis=0), 1e-12))

    best, lag = -math.inf, 0
    for rows in np.unique(np.linspace(0, limit, 26).astype(int)) if limit > 0 else []:
        fit = unit(position[rows::stride]).T @ unit(target[: len(target) - rows : stride])
        total = float(fit.max(0).sum())
        if total > best + 1e-6:
            best, lag = total, int(rows)
    return lag
