"""Units that other formats use, as factors to the log format's SI units."""

from __future__ import annotations

import math
import re

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.columns import unit

FACTORS = {
    "": {"": 1.0, "-": 1.0, "1": 1.0},
    "s": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9},
    "rad": {
        "rad": 1.0,
        "deg": math.pi / 180,
        "°": math.pi / 180,
        "mrad": 1e-3,
        "rev": 2 * math.pi,
        "turn": 2 * math.pi,
    },
    "rad/s": {
        "rad/s": 1.0,
        "deg/s": math.pi / 180,
        "°/s": math.pi / 180,
        "rpm": math.pi / 30,
        "rev/s": 2 * math.pi,
    },
    "Nm": {"nm": 1.0, "n.m": 1.0, "n*m": 1.0, "mnm": 1e-3, "ncm": 1e-2},
    "A": {"a": 1.0, "ma": 1e-3},
    "V": {"v": 1.0, "mv": 1e-3, "dv": 0.1},
    "degC": {"degc": 1.0, "°c": 1.0, "c": 1.0},
    "m/s^2": {"m/s^2": 1.0, "m/s2": 1.0, "m/s²": 1.0, "g": 9.80665, "mg": 9.80665e-3},
    "m": {"m": 1.0, "mm": 1e-3, "cm": 1e-2},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3},
    "N": {"n": 1.0, "kn": 1e3},
}
"""By SI unit of a signal: what a file may use instead, in lower letters, and its factor."""
SLIDING = {"rad": "m", "rad/s": "m/s", "Nm": "N"}
"""SI unit of a joint that slides, by that of one that turns."""
_HEADER = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<unit>[^\])]*)[\])]\s*$")


def split_header(header: str) -> tuple[str, str]:
    """Split the header of a column, such as `position/knee [deg]`.

    Args:
        header: the header.

    Returns:
        Name and unit; the unit is empty where there is none.
    """
    match = _HEADER.match(header.strip())
    return (match["name"], match["unit"]) if match else (header.strip(), "")


def factor(column: str, given: str, where: str) -> float:
    """Look up the factor from a unit to that of the log format. Signals of joints may have the
    units of joints that turn or that slide, as a log knows nothing of its robot.

    Args:
        column: whose unit it is.
        given: the unit; empty for that of the log format.
        where: file, for error messages.

    Returns:
        The factor.

    Raises:
        InputError: not a unit of this signal.
    """
    if not given:
        return 1.0
    own = unit(column)
    factors = FACTORS[own] | (FACTORS[SLIDING[own]] if own in SLIDING else {})
    unit_factor = factors.get(given.strip().lower().replace(" ", ""))
    if unit_factor is None:
        remedy = f"is no unit of this signal; there are {', '.join(k for k in factors if k)}"
        raise InputError(where, column, given, remedy)
    return unit_factor
