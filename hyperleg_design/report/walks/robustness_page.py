"""Robustness by one command: trials as Parquet, curves as JSON and as a figure."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.evaluate import protocol_for
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.protocol import Protocol, TTestProtocol
from hyperleg_design.evaluation.robustness import CurvePoint, curves, robustness
from hyperleg_design.report.style import save
from hyperleg_design.report.walks.robustness_figure import robustness_figure
from hyperleg_design.writing import (
    check_output_folder,
    output_folder,
    plain,
    write_bytes,
    write_json,
)

FIGURE, TRIALS, CURVES = "robustness.png", "trials.parquet", "curves.json"
"""Files of the folder."""


def run_robustness(
    policies: Sequence[str | Path],
    out: str | Path,
    *,
    conditions: Sequence[str] = (),
    trials: int = 10,
    protocol: Protocol | None = None,
    levels: Mapping[str, Sequence[float]] | None = None,
    workers: int = 2,
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Evaluate policies over conditions and write a folder.

    Args:
        policies: as in `robustness`.
        out: folder to write, replaced as a whole.
        conditions: as in `robustness`.
        trials: at each level.
        protocol: as in `robustness`; its number of trials is replaced.
        levels: as in `robustness`.
        workers: processes side by side.
        progress: show a bar.

    Returns:
        Points of the curves as plain values, as `curves.json` has them.

    Raises:
        InputError: as `robustness`, or no policy.
        OutputError: the folder is not ours, or cannot be written.
    """
    from tqdm import tqdm

    if not policies:
        raise InputError("robustness", "", None, "expects ONNX files")
    check_output_folder(out)
    protocol = (protocol or protocol_for(load_policy(policies[0]))).changed(trials=trials)
    with tqdm(disable=not progress, desc="robustness", unit="level", delay=0.1) as bar:

        def note(done: int, count: int, name: str) -> None:
            bar.total = count
            bar.set_postfix_str(name)
            bar.update(done - bar.n)

        table = robustness(
            policies,
            conditions,
            protocol=protocol,
            levels=levels,
            workers=workers,
            progress=note,
        )
    points = curves(table, "t_test" if isinstance(protocol, TTestProtocol) else "walk")
    rows = [_row(point) for point in points]
    with output_folder(out) as folder:
        write_bytes(folder / TRIALS, table.to_parquet(index=False))
        write_json(folder / CURVES, rows)
        save(robustness_figure(points), folder / FIGURE)
    return rows


def _row(point: CurvePoint) -> dict[str, Any]:
    """A point as plain values, None for what is not a number."""
    values = dataclasses.asdict(point)
    estimate = values.pop("estimate")
    estimate["confidence"] = estimate.pop("level")  # `level` is the condition's
    return dict(plain(values | estimate))
