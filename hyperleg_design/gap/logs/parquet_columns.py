"""Reading the columns of a log from Parquet."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs import blocks
from hyperleg_design.gap.logs.blocks import chosen_blocks, shortened
from hyperleg_design.gap.logs.columns import known_column, misspelt

if TYPE_CHECKING:
    import pyarrow.parquet


def parquet_columns(
    file: pyarrow.parquet.ParquetFile, path: Path
) -> tuple[np.ndarray, dict[str, np.ndarray], list[str]]:
    """Read the columns that a log may have from a Parquet file.

    Args:
        file: the open file.
        path: of the file, for messages.

    Returns:
        Times `(t,)` [s], values by column `(t,)` each, and remarks on what was left out.

    Raises:
        InputError: no column of times, no rows, a column that stands twice, is misspelt or holds
            no numbers.
    """
    import pyarrow

    schema = file.schema_arrow
    if "t" not in schema.names:
        remedy = "is missing: expects the time in seconds in a column t"
        raise InputError(path.name, "t", list(schema.names)[:6], remedy)
    if wrong := misspelt(schema.names):
        raise InputError(
            path.name, wrong[0], None, f"is no column of the log format; did you mean {wrong[1]}?"
        )
    wanted = ["t", *(c for c in schema.names if known_column(c))]
    if len(set(wanted)) != len(wanted):
        raise InputError(
            path.name, next(c for c in wanted if wanted.count(c) > 1), None, "stands twice"
        )
    for column in wanted:
        kind = schema.field(column).type
        if not (
            pyarrow.types.is_floating(kind)
            or pyarrow.types.is_integer(kind)
            or pyarrow.types.is_boolean(kind)
            or pyarrow.types.is_null(kind)
        ):
            raise InputError(
                path.name, column, str(kind), "is no column of numbers: expects floats"
            )
    rows = file.metadata.num_rows
    if not rows:
        raise InputError(path.name, "", None, "is an empty log: it has no rows")
    others = [c for c in schema.names if c not in wanted and not c.startswith("__")]
    remarks = []
    if others:
        some = ", ".join(others[:8]) + (" ..." if len(others) > 8 else "")
        remarks.append(f"columns that the format does not know were left out: {some}")
    chosen, size = chosen_blocks(rows, len(wanted)), blocks.BLOCK_ROWS
    parts: dict[str, list[np.ndarray]] = {c: [] for c in wanted}
    start = 0
    for group in range(file.metadata.num_row_groups):
        count = file.metadata.row_group(group).num_rows
        if count and chosen[start // size : (start + count - 1) // size + 1].any():
            first = start
            for batch in file.iter_batches(
                size, row_groups=[group], columns=wanted, use_threads=False
            ):
                keep = chosen[(first + np.arange(batch.num_rows)) // size]
                first += batch.num_rows
                if keep.any():
                    for column in wanted:
                        parts[column].append(_array(batch.column(column))[keep])
        start += count
    columns = {c: np.concatenate(parts.pop(c)) for c in wanted}
    time = columns.pop("t")
    if len(time) < rows:
        remarks.append(shortened(rows, len(time)))
    return time, columns, remarks


def _array(column: Any) -> np.ndarray:
    import pyarrow

    if pyarrow.types.is_null(column.type) or not len(column):
        return np.full(len(column), np.nan)
    values = column.cast(pyarrow.float64(), safe=False)
    if values.null_count:
        values = values.fill_null(np.nan)
    # by its buffer, as `to_numpy` imports pandas, which takes longer than to read a log
    start = values.offset * values.type.byte_width
    return np.frombuffer(values.buffers()[1], float, len(values), start).copy()
