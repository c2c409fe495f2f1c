"""Records of progress: finite numbers, and nothing from after the checkpoint."""

from __future__ import annotations

import json

import pytest

pytest.importorskip("tensorboard")
pytest.importorskip("torch")

from hyperleg_design.learning.progress import finite, log_measures, open_writer


def test_what_is_not_finite_is_none():
    given = {"a": float("nan"), "b": {"c": float("inf"), "d": 2.0}, "e": "text", "f": 3}
    assert finite(given) == {"a": None, "b": {"c": None, "d": 2.0}, "e": "text", "f": 3}


def test_lines_after_the_checkpoint_are_taken_back(tmp_path):
    writer = open_writer(tmp_path, 0, 8)
    for iteration in (1, 2, 3):
        log_measures(
            tmp_path, writer, {"iteration": iteration, "steps": 8 * iteration, "x": float("nan")}
        )
    writer.close()
    with (tmp_path / "progress.jsonl").open("a") as stream:
        stream.write('{"iteration": 4, "ste')  # the process was killed
    open_writer(tmp_path, 2, 8).close()
    rows = [json.loads(line) for line in (tmp_path / "progress.jsonl").read_text().splitlines()]
    assert rows == [{"iteration": i, "steps": 8 * i, "x": None} for i in (1, 2)]
