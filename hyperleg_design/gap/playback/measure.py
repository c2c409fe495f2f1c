"""How large the gap is, and where: by signal, joint, motor and regime, against the repeatability
floor.

Torque residuals count below `BAND` only: above it, noise of sensors and of differentiation
outweighs what a model can explain. At the motors, torques are those of the controller's map from
joints to motors, angles those of the transposed `joint_from_motor`. The floor, the size that a
residual has when nothing is wrong, comes from reference logs; else from pairs of test logs with the
same targets (half of the variance of their difference); else from the smooth-against-noisy split:
of torques the residual's own level above `BAND`, taken as white, of positions and velocities the
smoother's own error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.playback.repeatability import repeatability_floors
from hyperleg_design.gap.playback.sheets import (
    Sheet,
    regime_names,
    regime_values,
    root_mean_square,
    sheets_of,
)
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.writing import plain


@dataclass(frozen=True)
class Row:
    """The gap of one signal at one place, in one regime of its motion."""

    signal: str
    """`torque`, `drive`, `control`, `transmission`, `base`, `ground`, `position` or `velocity`."""
    unit: str
    """Unit of `gap`, `floor`, `mean` and `size`."""
    kind: str
    """`joint`, `motor`, `foot` or `robot`."""
    location: str
    """Name of the joint, motor or foot."""
    regime: str
    """`all`, or what the joint, motor or foot was doing."""
    gap: float
    """Root mean square of the residual in this regime."""
    floor: float
    """What it would be if nothing were wrong."""
    mean: float
    """Mean of the residual: what is lasting in it."""
    share: float
    """Of the squared excess over the floor of this signal at all places, what this place has; in a
    regime, of this place's."""
    size: float
    """Root mean square of the signal itself, where that means something; NaN else."""
    ticks: int
    """Number of ticks in this regime."""

    @property
    def excess(self) -> float:
        """Root of the squared gap above the squared floor."""
        return float(np.sqrt(max(self.gap**2 - self.floor**2, 0.0)))


@dataclass(frozen=True)
class Gap:
    """How far logs are from the simulation, beyond the repeatability of the robot."""

    rows: tuple[Row, ...]
    floor_from: str
    """`reference`, `repeats` or `split`: where the floor comes from."""
    notes: tuple[str, ...] = ()

    def table(self) -> dict[str, list[object]]:
        """Tabulate the gap.

        Returns:
            Columns by name, excess included.
        """
        names = [f.name for f in fields(Row)]
        return {
            **{n: [getattr(r, n) for r in self.rows] for n in names},
            "excess": [r.excess for r in self.rows],
        }

    def mapping(self) -> dict[str, object]:
        """Write the gap as JSON takes it.

        Returns:
            Nested mappings; what is unknown is None.
        """
        return {
            "floor_from": self.floor_from,
            "notes": list(self.notes),
            "rows": plain([asdict(row) for row in self.rows]),
        }

    def select(
        self, signal: str = "", kind: str = "", location: str = "", regime: str = "all"
    ) -> tuple[Row, ...]:
        """Select rows; an empty text stands for any.

        Args:
            signal: such as `position`.
            kind: of place, such as `joint`.
            location: such as `knee`.
            regime: such as `all`.

        Returns:
            The rows.
        """
        wanted = {"signal": signal, "kind": kind, "location": location, "regime": regime}
        return tuple(
            r for r in self.rows if all(not v or getattr(r, k) == v for k, v in wanted.items())
        )


def measure(
    signals: Sequence[Signals], reference: Sequence[Signals] = (), *, predict: bool = True
) -> Gap:
    """Measure the gap of logs, in every signal that they allow.

    Args:
        signals: conditioned logs of one robot.
        reference: conditioned logs of the same robot when all was well.
        predict: also gaps of position and velocity, from short replays.

    Returns:
        The rows of the gap, and where its noise floor comes from.

    Raises:
        InputError: no log.
    """
    if not signals:
        raise InputError("measure", "logs", None, "are missing: give at least one log")
    sheets = [sheets_of(s, predict) for s in signals]
    floors, origin = repeatability_floors(
        signals, sheets, [sheets_of(s, predict) for s in reference]
    )
    rows: list[Row] = []
    for key in dict.fromkeys(k for each in sheets for k in each):
        rows += _rows([each[key] for each in sheets if key in each], floors)
    notes = dict.fromkeys(f"{s.log.name}: {note}" for s in signals for note in s.notes)
    return Gap(tuple(rows), origin, tuple(notes))


def _rows(group: Sequence[Sheet], floors: dict[tuple[str, str, str], np.ndarray]) -> list[Row]:
    first = group[0]
    key = (first.signal, first.kind)
    names = first.names
    default = floors.get((*key, "all"), np.zeros(len(names)))
    size = root_mean_square(np.array([s.size for s in group]))
    whole = 0.0
    squares: dict[str, np.ndarray] = {}
    rows: list[tuple[int, Row]] = []
    for regime in regime_names(group):
        values = np.concatenate([regime_values(s, regime) for s in group])
        gap = root_mean_square(values)
        floor = np.nan_to_num(floors.get((*key, regime), default))
        ticks = np.isfinite(values).sum(0)
        if regime not in {n for s in group for n in s.bands}:
            squared = np.maximum(np.nan_to_num(gap) ** 2 - floor**2, 0.0) * ticks
        else:
            squared = np.nan_to_num(gap) ** 2 * ticks  # the floor of the whole is none of a band's
            floor = np.nan_to_num(floors.get((*key, regime), np.zeros(len(names))))
        if regime == "all":
            whole, squares["all"] = float(squared.sum()), squared
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = np.where(ticks > 0, np.nansum(values, 0) / np.maximum(ticks, 1), np.nan)
            share = squared / whole if regime == "all" else squared / squares["all"]
        for k, name in enumerate(names):
            if not ticks[k]:
                continue
            what = first.signal, first.units[k], first.kind, name, regime
            part = float(min(share[k], 1.0)) if np.isfinite(share[k]) else 0.0
            numbers = float(gap[k]), float(floor[k]), float(mean[k]), part, float(size[k])
            rows.append((k, Row(*what, *numbers, int(ticks[k]))))
    return [row for _, row in sorted(rows, key=lambda pair: pair[0])]
