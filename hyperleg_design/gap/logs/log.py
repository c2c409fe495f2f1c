"""One recording: a row a tick, columns `signal/name`, and what is known of the robot; read from and
written to Parquet.

| column | unit | |
|---|---|---|
| `t` | s | strictly rising; not necessarily even |
| `position_target/J`, `position/J` | rad | of joint J |
| `velocity/J` | rad/s | |
| `joint_torque/J` | Nm | measured at the joint |
| `motor_torque_command/M`, `motor_torque/M` | Nm | of motor M |
| `motor_current/M` | A | |
| `motor_velocity/M` | rad/s | |
| `motor_temperature/M` | degC | |
| `battery_voltage` | V | |
| `gyro/x`, `y`, `z` | rad/s | base frame |
| `accelerometer/x`, `y`, `z` | m/s^2 | base frame; +9.81 upward at rest |
| `base_position/x`, `y`, `z` | m | world |
| `base_orientation/w`, `x`, `y`, `z` | - | unit quaternion, world from base |
| `base_velocity/x`, `y`, `z` | m/s | world |
| `contact_force/FOOT_x`, `_y`, `_z` | N | of the ground on the foot, world |

Unknown values are NaN.
"""

from __future__ import annotations

import dataclasses
import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.gap.logs import blocks
from hyperleg_design.gap.logs.columns import CONTACT, MOTOR_SIGNALS, VECTOR_SIGNALS, known_column
from hyperleg_design.gap.logs.metadata import Metadata, metadata_from_mapping, read_metadata_mapping
from hyperleg_design.gap.logs.parquet_columns import parquet_columns
from hyperleg_design.gap.logs.tidy import check_clock, tidied
from hyperleg_design.writing import write_bytes

SCHEMA_KEY = b"hyperleg"
"""Of the Parquet schema's metadata."""


@dataclass(frozen=True, eq=False)
class Log:
    """One recording of `t` ticks; arrays are read-only.

    Raises:
        InputError: a time base that does not rise strictly, an unknown column, or columns of
            different lengths.
    """

    name: str
    time: np.ndarray
    """Times of the rows `(t,)` [s]."""
    signals: Mapping[str, np.ndarray]
    """By column, `(t,)` each; units in `UNITS`; NaN where unknown."""
    metadata: Metadata = field(default_factory=Metadata)
    folder: str = ""
    """In which it was found: a `robot` file of its metadata may stand there; not written into
    files."""

    def __post_init__(self) -> None:
        """Check."""
        time = _frozen(self.time, self.name, "t")
        check_clock(time, self.name)
        object.__setattr__(self, "time", time)
        signals = {}
        for column, values in self.signals.items():
            if not known_column(column):
                remedy = (
                    "is no column of the log format: expects signal/name, such as "
                    "position/left_knee"
                )
                raise InputError(self.name, column, None, remedy)
            signals[column] = _frozen(values, self.name, column)
            if signals[column].shape != time.shape:
                remedy = f"expects one value a tick, {time.shape}"
                raise InputError(self.name, column, signals[column].shape, remedy)
        object.__setattr__(self, "signals", signals)

    def has(self, kind: str, name: str = "") -> bool:
        """Decide whether the log has a column with at least one known value.

        Args:
            kind: signal, such as `position`.
            name: of the joint or motor; empty for signals without one.

        Returns:
            True if it has.
        """
        values = self.signals.get(f"{kind}/{name}" if name else kind)
        return values is not None and bool(np.isfinite(values).any())

    def stack(self, kind: str, names: Iterable[str]) -> np.ndarray:
        """Put columns `kind/name` beside each other.

        Args:
            kind: signal, such as `position`.
            names: of joints or motors.

        Returns:
            `(t, len(names))`; NaN where a column is missing.
        """
        missing = np.full(len(self.time), np.nan)
        columns = [self.signals.get(f"{kind}/{name}", missing) for name in names]
        return np.stack(columns, -1) if columns else np.empty((len(self.time), 0))

    def vector(self, kind: str) -> np.ndarray:
        """Collect the components of a vector signal.

        Args:
            kind: `gyro`, `accelerometer` or one of `base_...`.

        Returns:
            `(t, 3)` or `(t, 4)`; NaN where a component is missing.
        """
        return self.stack(kind, VECTOR_SIGNALS[kind])

    def column(self, column: str) -> np.ndarray:
        """Look up one column.

        Args:
            column: its full name, such as `position/knee`.

        Returns:
            `(t,)`; NaN where the column is missing.
        """
        values = self.signals.get(column)
        return np.full(len(self.time), np.nan) if values is None else values

    def names(self, *kinds: str) -> tuple[str, ...]:
        """List the joints or motors that have any of some signals.

        Args:
            kinds: signals, such as `position`.

        Returns:
            Names, in the order of the columns.
        """
        return tuple(
            dict.fromkeys(c.partition("/")[2] for c in self.signals if c.partition("/")[0] in kinds)
        )

    @property
    def joints(self) -> tuple[str, ...]:
        """With a measured position, in the order of the columns."""
        return self.names("position")

    @property
    def motors(self) -> tuple[str, ...]:
        """Names of the motors that have any signal of their own."""
        return self.names(*MOTOR_SIGNALS)

    @property
    def feet(self) -> tuple[str, ...]:
        """Names of the feet or pads that have a contact force."""
        return tuple(dict.fromkeys(name[:-2] for name in self.names(CONTACT)))

    @property
    def step(self) -> float:
        """Median time between ticks [s]."""
        return float(np.median(np.diff(self.time)))

    @property
    def duration(self) -> float:
        """Time from the first to the last tick [s]."""
        return float(self.time[-1] - self.time[0])

    def part(self, rows: slice | np.ndarray, name: str = "") -> Log:
        """Copy some rows of the log.

        Args:
            rows: a slice, or indices.
            name: of the copy; that of the log by default.

        Returns:
            The copy.
        """
        return self.changed(
            name=name or self.name,
            time=self.time[rows],
            signals={c: v[rows] for c, v in self.signals.items()},
        )

    def changed(self, **values: Any) -> Log:
        """Copy the log with other values of some fields.

        Args:
            values: new values by field.

        Returns:
            The copy.
        """
        return dataclasses.replace(self, **values)

    def remarked(self, *remarks: str) -> Log:
        """Copy the log with remarks in its metadata that state what was changed or is lacking.

        Args:
            remarks: the remarks.

        Returns:
            The copy.
        """
        return self.changed(metadata=self.metadata.remarked(*remarks)) if remarks else self


def write_log(path: str | os.PathLike[str], log: Log) -> Path:
    """Write a log as one Parquet file, with its metadata inside.

    Args:
        path: of the file.
        log: the log.

    Returns:
        The path.

    Raises:
        OutputError: it cannot be written.
    """
    import pyarrow
    import pyarrow.parquet

    schema_metadata = {SCHEMA_KEY: json.dumps(log.metadata.mapping(), allow_nan=False).encode()}
    table = pyarrow.table({"t": log.time, **log.signals}).replace_schema_metadata(schema_metadata)
    sink = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(table, sink, compression="zstd", row_group_size=blocks.BLOCK_ROWS)
    return write_bytes(path, sink.getvalue().to_pybytes())


def read_log(path: str | os.PathLike[str]) -> Log:
    """Read a Parquet log and its side file `NAME.json`, whose fields take precedence.

    Of recordings with more than `blocks.MAX_VALUES` numbers, only blocks spread evenly over the
    recording are read, and a remark states this.

    Args:
        path: of the file.

    Returns:
        The log.

    Raises:
        InputError: missing, truncated or empty file, no time, a column of texts, a clock that runs
            backwards, bad metadata.
    """
    import pyarrow
    import pyarrow.parquet

    path = Path(path)
    try:
        with pyarrow.parquet.ParquetFile(path) as file:
            time, signals, remarks = parquet_columns(file, path)
            inside = (file.schema_arrow.metadata or {}).get(SCHEMA_KEY)
    except FileNotFoundError:
        raise InputError(str(path), "", None, "does not exist") from None
    except (pyarrow.ArrowException, OSError, ValueError) as error:
        remedy = f"is no whole Parquet file ({in_short(error, 90)}): record or copy it again"
        raise InputError(path.name, "", None, remedy) from None
    return finished_log(path, time, signals, metadata_beside(path, _inside(inside, path)), remarks)


def finished_log(
    path: Path,
    time: np.ndarray,
    signals: Mapping[str, np.ndarray],
    metadata: Metadata,
    remarks: Iterable[str] = (),
    name: str = "",
) -> Log:
    """Build a log from what a reader found in a file: tidied, checked, with its remarks.

    Args:
        path: of the file.
        time: [s], `(t,)`.
        signals: by column, `(t,)` each.
        metadata: of the log.
        remarks: of the reader.
        name: of the log; that of the file by default.

    Returns:
        The log.

    Raises:
        InputError: an unusable clock, or no position.
    """
    time, signals, more = tidied(time, signals, path.name)
    check_clock(time, path.name)
    positions = {c: values for c, values in signals.items() if c.startswith("position/")}
    if not any(np.isfinite(values).any() for values in positions.values()):
        what = f"no number in {', '.join(positions)}" if positions else "is missing"
        remedy = f"{what}: expects the measured angle of at least one joint, in position/JOINT"
        raise InputError(path.name, "position/...", None, remedy)
    return Log(
        name or path.stem,
        time,
        signals,
        metadata.remarked(*remarks, *more),
        str(path.resolve().parent),
    )


def metadata_beside(path: Path, inside: Mapping[str, Any]) -> Metadata:
    """Combine metadata found in a file with the side file `NAME.json`, whose fields take
    precedence.

    Args:
        path: of the file.
        inside: fields found in the file.

    Returns:
        The metadata.
    """
    side = path.with_suffix(".json")
    if side != path and side.is_file():
        return metadata_from_mapping({**inside, **read_metadata_mapping(side)}, side.name)
    return metadata_from_mapping(inside, path.name)


def _inside(content: bytes | None, path: Path) -> dict[str, Any]:
    if content is None:
        return {}
    try:
        fields = json.loads(content)
    except ValueError:
        raise InputError(path.name, "schema metadata hyperleg", None, "is not JSON") from None
    if not isinstance(fields, dict):
        raise InputError(
            path.name, "schema metadata hyperleg", fields, "expects names with values, { ... }"
        )
    return fields


def _frozen(values: Any, where: str, column: str) -> np.ndarray:
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(where, column, values, "expects numbers") from None
    if array.ndim != 1:
        raise InputError(where, column, array.shape, "expects one value a tick")
    if np.isinf(array).any():
        remedy = "expects finite numbers, NaN where unknown"
        raise InputError(where, column, float(array[np.isinf(array)][0]), remedy)
    array.flags.writeable = False
    return array
