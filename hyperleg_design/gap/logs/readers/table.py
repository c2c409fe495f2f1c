"""CSV files: a header of our column names, with units if they are not SI (`position/knee [deg]`), a
row a tick.

Columns of other names are used through a mapping from the file's names to ours, given to the reader
or as `columns` in the side file. Where the header has no units, `units` of the side file may state
them, of signals or of columns: `{"position": "deg", "t": "ms"}`. The time may be called t, time or
timestamp. Separators comma, semicolon (then the decimal mark may be a comma) or tab.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.gap.logs import blocks as row_blocks
from hyperleg_design.gap.logs.blocks import chosen_blocks, shortened
from hyperleg_design.gap.logs.columns import known_column, misspelt
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.readers.source import beside, build_log, side_file
from hyperleg_design.gap.logs.readers.units import factor, split_header

TIMES = ("t", "time", "timestamp")
"""Names of the time where none is mapped."""


def read_csv(
    path: Path, metadata: Mapping[str, Any] | None = None, mapping: Mapping[str, str] | None = None
) -> list[Log]:
    """Read a CSV file.

    Args:
        path: of the file.
        metadata: fields that win over those of the side file.
        mapping: column of the log format (or `t`) by the file's own name, with or without its unit.

    Returns:
        One log.

    Raises:
        InputError: empty, no time, a mapped column that is missing, an unknown unit, or a column of
        texts.
    """
    user_metadata = beside(path, metadata)
    header, separator = _header(path)
    chosen = _chosen(
        header,
        {**_texts(user_metadata, "columns", path), **(mapping or {})},
        _texts(user_metadata, "units", path),
        path.name,
    )
    if "t" not in chosen:
        raise InputError(
            path.name, "t", header[:6], "is missing: expects the time in a column t, or mapped to t"
        )
    rows = _count(path)
    if rows < 1:
        raise InputError(path.name, "", None, "is an empty log: it has a header but no rows")
    blocks = chosen_blocks(rows, len(chosen))
    values = _read(path, separator, chosen, blocks)
    time = values.pop("t")
    remarks = [] if blocks.all() else [shortened(rows, len(time))]
    used = {place for place, _ in chosen.values()}
    others = [name for i, name in enumerate(header) if i not in used and name]
    if others:
        remarks.append(
            f"columns that are not mapped were left out: "
            f"{', '.join(others[:8])}{' ...' if len(others) > 8 else ''}"
        )
    return [build_log(path, path.stem, time, values, {}, user_metadata, remarks)]


def _texts(user_metadata: Mapping[str, Any], field: str, path: Path) -> dict[str, str]:
    """A field of the side file that gives texts by name."""
    texts = user_metadata.get(field, {})
    if not isinstance(texts, Mapping) or not all(isinstance(v, str) for v in texts.values()):
        raise InputError(side_file(path).name, field, texts, 'expects texts by name, {"a": "b"}')
    return dict(texts)


def _header(path: Path) -> tuple[list[str], str]:
    try:
        with path.open(encoding="utf-8-sig") as stream:
            line = stream.readline()
    except UnicodeDecodeError:
        raise InputError(path.name, "", None, "is not a text file in UTF-8") from None
    except OSError as error:
        raise InputError(str(path), "", None, f"cannot be read ({error.strerror})") from None
    if not line.strip():
        raise InputError(path.name, "", None, "is an empty log: expects a header of column names")
    separator = max(",;\t", key=line.count)
    return [
        name.strip().strip('"').lstrip("#").strip() for name in line.rstrip("\r\n").split(separator)
    ], separator


def _chosen(
    header: list[str], mapping: Mapping[str, str], units: Mapping[str, str], where: str
) -> dict[str, tuple[int, float]]:
    """Place in the file and factor of each column of the log."""
    names = [split_header(name) for name in header]
    chosen: dict[str, tuple[int, float]] = {}
    missing = [name for name in mapping if name not in header and name not in [n for n, _ in names]]
    if missing:
        raise InputError(where, missing[0], header[:8], "is mapped but no column of the file")
    if wrong := misspelt(mapping.get(name, name) for name, _ in names):
        raise InputError(
            where, wrong[0], None, f"is no column of the log format; did you mean {wrong[1]}?"
        )
    for place, (name, unit_in_header) in enumerate(names):
        column = mapping.get(header[place], mapping.get(name, name))
        column, unit_in_mapping = split_header(column)
        if column.lower() in TIMES and "t" not in mapping.values():
            column = "t"
        if column != "t" and not known_column(column):
            if column != name:
                raise InputError(where, name, column, "is mapped to no column of the log format")
            continue
        if column in chosen:
            raise InputError(where, column, None, "stands twice")
        stated = units.get(column, units.get(column.partition("/")[0], ""))
        given = unit_in_mapping or unit_in_header or stated
        chosen[column] = (place, factor(column, given, where))
    signals = {column.partition("/")[0] for column in chosen}
    if unknown := [name for name in units if name not in chosen and name not in signals]:
        remedy = f"is in no column of the file; expects {', '.join(sorted(signals))}, or a column"
        raise InputError(where, f"units.{unknown[0]}", units[unknown[0]], remedy)
    return chosen


def _count(path: Path) -> int:
    """Rows below the header."""
    lines, last = 0, b"\n"
    with path.open("rb") as stream:
        while part := stream.read(1 << 20):
            lines += part.count(b"\n")
            last = part[-1:]
    return lines + (last != b"\n") - 1


def _read(
    path: Path, separator: str, chosen: dict[str, tuple[int, float]], blocks: np.ndarray
) -> dict[str, np.ndarray]:
    import pandas as pd

    places = [place for place, _ in chosen.values()]
    parts: dict[str, list[np.ndarray]] = {column: [] for column in chosen}
    try:
        with pd.read_csv(
            path,
            sep=separator,
            header=None,
            skiprows=1,
            usecols=sorted(places),
            chunksize=row_blocks.BLOCK_ROWS,
            encoding="utf-8-sig",
            decimal="," if separator == ";" and _decimal_comma(path) else ".",
            comment=None,
            skip_blank_lines=True,
        ) as chunks:
            for number, chunk in enumerate(chunks):
                if number < len(blocks) and not blocks[number]:
                    continue
                for column, (place, scale) in chosen.items():
                    parts[column].append(
                        _numbers(chunk[place], column, path.name, number * row_blocks.BLOCK_ROWS)
                        * scale
                    )
    except (ValueError, pd.errors.ParserError, OSError) as error:
        raise InputError(path.name, "", None, f"is no table ({in_short(error, 90)})") from None
    return {
        column: np.concatenate(blocks_of_values) if blocks_of_values else np.empty(0)
        for column, blocks_of_values in parts.items()
    }


def _numbers(values: Any, column: str, where: str, first: int) -> np.ndarray:
    import pandas as pd

    if values.dtype != object and pd.api.types.is_numeric_dtype(values):
        return values.to_numpy(float)
    numbers = pd.to_numeric(values, errors="coerce")
    texts = (
        values.notna()
        & numbers.isna()
        & ~values.astype(str).str.strip().str.lower().isin(["", "nan", "null", "none", "na", "-"])
    )
    if texts.any():
        row = int(texts.to_numpy().argmax())
        raise InputError(
            where, f"{column}, row {first + row + 2}", str(values.iloc[row]), "expects a number"
        )
    return numbers.to_numpy(float)


def _decimal_comma(path: Path) -> bool:
    with path.open(encoding="utf-8-sig") as stream:
        stream.readline()
        return "," in stream.readline()
