"""Records of progress: finite numbers, and nothing from after the checkpoint."""

from __future__ import annotations

import json

import pytest

pytest.importorskip("tensorboard")
pytest.importorskip("torch")

from hyperleg_design.learning.records.progress import (
    finite,
    log_measures,
    open_writer,
    progress_line,
)


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


def test_a_line_shows_steps_in_millions_and_leaves_out_terms_without_a_value():
    measures = {
        "terms": {"speed": 1.25, "slip": 0.0},
        "steps": 1_500_000,
        "total": 6_000_000,
        "rate": 12345.6,
        "stage": 2,
        "assist": 0.5,
        "reward": 1.25,
        "speed": 1.0,
        "falls": 0.25,
        "cost_of_transport": 0.4,
        "learning_rate": 3e-4,
    }
    line = progress_line("walk", "toe seed 1", measures, {"arrived": 0.5}, 120.0)
    assert line.startswith("walk toe seed 1 | 1.50/6.0 M steps, 12346/s | stage 2, assist 0.50")
    assert "reward 1.25 (speed +1.25)" in line
    assert line.endswith("| trial arrived 0.50 | left 2 min")
    assert "trial" not in progress_line("walk", "toe seed 1", measures, {}, 120.0)
