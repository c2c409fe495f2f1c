"""Tables of a sweep as Parquet, each column with its unit; the whole table carries what made it."""

from __future__ import annotations

import io
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.sweep.measuring import measures
from hyperleg_design.sweep.measuring.evaluate import Columns
from hyperleg_design.sweep.spaces.definition import Sweep

if TYPE_CHECKING:
    import pyarrow as pa

METADATA_KEY = b"hyperleg_sweep"
"""Key of the schema's metadata under which the resolved configuration stands, as JSON."""

ROW_GROUP = 32_768
"""Rows of a row group of the finished table, whatever the chunks were, so that its bytes do not
depend on those."""


def schema(sweep: Sweep) -> pa.Schema:
    """Describe the columns of a sweep's table, with unit and meaning.

    Args:
        sweep: the definition.

    Returns:
        The schema.
    """
    import pyarrow as pa

    def field(name: str, kind: Any, doc: str, unit: str = "") -> Any:
        return pa.field(name, kind, metadata={"unit": unit, "doc": doc})

    fields = [
        field("sample", pa.int64(), "number of the sample"),
        field("variant", pa.string(), "ablation of the toe"),
    ]
    for axis in sweep.axes:
        doc = f"axis: {'factor on' if axis.scaled else 'sets'} {', '.join(axis.paths)}"
        fields.append(
            field(axis.name, pa.float64() if axis.numeric else pa.string(), doc, axis.unit)
        )
    fields.append(field("rejected", pa.string(), "why this makes no design; empty where it does"))
    for column in measures.columns(sweep.measures, sweep.base):
        measure = measures.measure_of(column)
        fields.append(field(column, pa.float64(), measure.doc, measure.unit))
    return pa.schema(fields)


def to_bytes(sweep: Sweep, columns: Columns) -> bytes:
    """Write some rows as a Parquet file.

    Args:
        sweep: the definition, which knows the columns.
        columns: values by column.

    Returns:
        The content of the file.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    stream = io.BytesIO()
    pq.write_table(
        pa.table(
            {name: pa.array(values) for name, values in columns.items()}, schema=schema(sweep)
        ),
        stream,
    )
    return stream.getvalue()


def rows_of(path: Path) -> int:
    """Count the rows of a Parquet file.

    Args:
        path: of the file.

    Returns:
        The count; -1 where the file cannot be read.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        return int(pq.read_metadata(path).num_rows)
    except (OSError, pa.ArrowException):
        return -1


def join(sweep: Sweep, parts: Iterable[Path], path: Path, metadata: Mapping[str, Any]) -> None:
    """Join several Parquet files into one, in their order, with only one row group in memory.

    Args:
        sweep: the definition, which knows the columns.
        parts: files to join.
        path: file to write.
        metadata: what made the table.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    target = schema(sweep).with_metadata(
        {METADATA_KEY: json.dumps(metadata, sort_keys=True).encode()}
    )
    texts = [field.name for field in target if field.type == pa.string()]
    with pq.ParquetWriter(path, target, compression="zstd", use_dictionary=texts) as writer:
        held: list[pa.Table] = []
        rows = 0
        for part in parts:
            held.append(pq.read_table(part, schema=target))
            rows += held[-1].num_rows
            while rows >= ROW_GROUP:
                whole = pa.concat_tables(held).combine_chunks()
                writer.write_table(
                    whole.slice(0, ROW_GROUP).combine_chunks(), row_group_size=ROW_GROUP
                )
                held = [whole.slice(ROW_GROUP)]
                rows -= ROW_GROUP
        if rows:
            writer.write_table(pa.concat_tables(held).combine_chunks(), row_group_size=ROW_GROUP)


def read(path: Path, columns: list[str] | None = None) -> Columns:
    """Read columns of a finished table.

    Args:
        path: of the file.
        columns: their names; all by default.

    Returns:
        Values by column.

    Raises:
        InputError: no such file, or no table of a sweep.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        table = pq.read_table(path, columns=columns)
    except (OSError, pa.ArrowException) as error:
        raise InputError(str(path), "", None, f"is no table of a sweep ({error})") from None
    return {name: _plain(table[name]) for name in table.column_names}


def _plain(column: pa.ChunkedArray) -> np.ndarray:
    values: np.ndarray = column.to_numpy()
    return values


def read_metadata(path: Path) -> dict[str, Any]:
    """Read what made a finished table.

    Args:
        path: of the file.

    Returns:
        The resolved configuration, versions and commit.

    Raises:
        InputError: no such file, or no table of a sweep.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        metadata = pq.read_schema(path).metadata or {}
    except (OSError, pa.ArrowException) as error:
        raise InputError(str(path), "", None, f"is no table of a sweep ({error})") from None
    if METADATA_KEY not in metadata:
        raise InputError(str(path), "", None, "is a Parquet file, but not the table of a sweep")
    metadata_read: dict[str, Any] = json.loads(metadata[METADATA_KEY])
    return metadata_read
