"""Whether measured positions and velocities fit each other.

The change of position over a window is compared with the integral of velocity over it, which needs
no differentiation of noise; a wrong unit shows as a slope of 57.3, a swapped joint as one that fits
another's motion.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from hyperleg_design.gap.checks.rules import RULES
from hyperleg_design.gap.checks.slopes import DEGREES, fitted_correlations, fitted_slopes
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.results.finding import ERROR, WARNING, Finding

RPM = 30 / math.pi
FEWEST = 2
"""Rows from which a motion has a spread."""


def implausible_motion(log: Log) -> Iterator[Finding]:
    """Find velocities that do not fit the change of the positions: units, signs, swapped joints.

    Args:
        log: the log.

    Returns:
        The findings.
    """
    joints = [j for j in log.joints if log.has("velocity", j)]
    if not joints:
        return
    moved, integral = _windows(log, joints)
    if len(moved) < FEWEST:
        return
    slope, fit = fitted_slopes(moved, integral)
    moving = (
        np.nanstd(moved, axis=0)
        > 3 * np.nanmedian(np.abs(np.diff(moved, axis=0)), axis=0) / math.sqrt(len(moved)) + 1e-4
    )
    units = (
        (DEGREES, "velocity in deg/s or position in another unit"),
        (1 / DEGREES, "position in degrees"),
        (RPM, "velocity in rpm"),
    )
    for i, joint in enumerate(joints):
        column = f"velocity/{joint}"
        if not moving[i] or not np.isfinite(fit[i]):
            continue
        if np.nanstd(integral[:, i]) == 0:
            remedy = "leave the column out, or mend the sensor"
            yield Finding(ERROR, column, "never changes though the joint moves", remedy)
            continue
        rivals = fitted_correlations(moved, integral[:, i])
        rivals[i] = -1
        best = int(np.nanargmax(rivals)) if np.isfinite(rivals).any() else i
        ratio, close = abs(slope[i]), RULES.unit.tolerance
        unit = next((text for value, text in units if abs(ratio / value - 1) < close), "")
        if abs(fit[i]) < RULES.unit.strange and rivals[best] > RULES.unit.fits:
            text = (
                f"follows the motion of {joints[best]} (correlation {rivals[best]:.2f}), not "
                f"its own ({fit[i]:.2f})"
            )
            yield Finding(ERROR, column, text, "the columns of two joints are swapped: rename them")
        elif fit[i] < -RULES.unit.fits:
            text = "runs against the rate of its position"
            yield Finding(ERROR, column, text, "flip the sign of one of the two")
        elif fit[i] > RULES.unit.strange and unit:
            text = f"is {slope[i]:.3g} times the rate of its position: {unit}"
            yield Finding(ERROR, column, text, "convert to rad and rad/s")
        elif fit[i] > RULES.unit.fits and abs(slope[i] - 1) > RULES.unit.tolerance:
            text = f"is {slope[i]:.3g} times the rate of its position"
            remedy = "is it the motor's, before a reduction? then call it motor_velocity"
            yield Finding(WARNING, column, text, remedy)
        elif fit[i] < RULES.unit.strange:
            text = f"hardly follows the rate of its position (correlation {fit[i]:.2f})"
            yield Finding(
                WARNING, column, text, "check clock and filter of the velocity, or leave it out"
            )


def _windows(log: Log, joints: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Change of position, and integral of velocity, over windows `(k, n)` [rad]."""
    width = max(1, round(RULES.unit.window / log.step))
    position, velocity = log.stack("position", joints), log.stack("velocity", joints)
    steps = np.diff(log.time)[:, None]
    parts = np.nan_to_num(0.5 * (velocity[1:] + velocity[:-1])) * steps
    area = np.concatenate([np.zeros((1, len(joints))), np.cumsum(parts, 0)])
    lost = np.cumsum(~np.isfinite(velocity), 0)
    moved, integral = position[width:] - position[:-width], area[width:] - area[:-width]
    unknown = (lost[width:] > lost[:-width]) | (
        (log.time[width:] - log.time[:-width]) > 2 * width * log.step
    )[:, None]
    moved[unknown] = np.nan
    stride = max(1, width // 2)
    return moved[::stride], integral[::stride]
