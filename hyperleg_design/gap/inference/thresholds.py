"""Rules of a diagnosis that are fixed before it sees a log: `sim/gap_thresholds.yaml`."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from pathlib import Path

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.reading import read_yaml, short_name

FILE = "gap_thresholds"


@dataclass(frozen=True)
class Thresholds:
    """See the file for what each means and where it comes from."""

    floor_torque: float
    floor_friction: float
    floor_turning: float
    floor_leak: float
    floor_weight: float
    information: float
    visible: float
    visible_afoot: float
    least_gap: float
    evident: float
    evident_doubtful: float
    worth: float
    second_worth: float
    second_evident: float
    second_instead: float
    second_visible: float
    seldom: float
    failing: float
    required: float
    far: float
    far_required: float
    beyond: float
    beyond_evident: float
    together: float
    together_joints: float
    largest_excess: float
    alike: float
    alike_closed: float
    temperature: float
    unlisted: float
    likely: float
    most_certain: float
    doubt: float
    interval: float


def load_thresholds(path: str | Path | None = None) -> Thresholds:
    """The shipped rules, or those of another file.

    Raises:
        InputError: no such file, a rule missing, unknown or no finite number.
    """
    place = resources.find("sim", FILE) if path is None else Path(path)
    content = read_yaml(place)
    names = [f.name for f in fields(Thresholds)]
    for name in content:
        if name not in names:
            raise InputError(
                short_name(place), name, None, f"is no rule: expects {', '.join(names)}"
            )
    values = {}
    for name in names:
        value = content.get(name)
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or not math.isfinite(value)
            or value < 0
        ):
            raise InputError(
                short_name(place), name, value, "expects a finite number, not negative"
            )
        values[name] = float(value)
    return Thresholds(**values)
