"""Checks that designs of every family share, and how a number of a design is refused."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,99}")
"""Names of designs; they become file names, and names in URDF and MJCF."""


def refuse(where: str, field: str, good: Any, value: Any, remedy: str) -> None:
    """Raise where a number of a design is not good, in any robot of a batch.

    Args:
        where: file or option that the design comes from.
        field: dotted path of the number.
        good: whether it is good, `()` or one a robot.
        value: the number, or one a robot.
        remedy: what would be right.

    Raises:
        InputError: shows the value, that of the first bad robot where they differ.
    """
    good, value = np.asarray(good), np.asarray(value)
    if np.all(good):
        return
    shown = value if good.ndim == 0 or value.shape[:1] != good.shape else value[np.argmin(good)]
    raise InputError(where, field, shown.tolist(), remedy, bad=~good)


def check_name(design: RobotDesign, where: str) -> None:
    """Check that a design's name can name files and parts of models.

    Args:
        design: a robot or batch.
        where: file or option that it comes from.

    Raises:
        InputError: it cannot.
    """
    if not isinstance(design.name, str) or not NAME.fullmatch(design.name):
        raise InputError(
            where,
            "name",
            design.name,
            "expects a letter or digit, then letters, digits, dots, dashes or underscores, 100 at "
            "most",
        )


def check_batch(design: RobotDesign, where: str) -> None:
    """Check that the values of a batch are all of one length.

    Args:
        design: a robot or batch.
        where: file or option that it comes from.

    Raises:
        InputError: names two values whose lengths differ.
    """
    sizes = {path: size for path, size in design.batch_sizes().items() if size > 1}
    if len(set(sizes.values())) > 1:
        first, last = min(sizes, key=lambda p: sizes[p]), max(sizes, key=lambda p: sizes[p])
        remedy = f"is the length of its batch, but that of {first} is {sizes[first]}"
        raise InputError(where, last, sizes[last], f"{remedy}; make them equal")
