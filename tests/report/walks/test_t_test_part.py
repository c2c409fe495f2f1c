"""T-tests beside Table IV: ways, animations, and where the time goes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.report.page import Picture, Table
from hyperleg_design.report.walks.t_test_part import table_four
from tests.report.conftest import of_kind


def test_ways_are_drawn_kept_runs_animated_and_the_time_is_broken_down(found, draw):
    content = table_four(found, draw).content
    assert any("cannot be reproduced yet" in text for text in content[:2])
    files = [picture.file for picture in of_kind(content, Picture)]
    assert files == ["figures/ways_t_test.png", "figures/t_test_toe.gif"]
    assert all((draw.folder / file).stat().st_size for file in files)
    (table,) = (item for item in of_kind(content, Table) if item.headers[0] == "stretch")
    assert [row[0] for row in table.rows][:2] == ["A to B", "turn at B (1)"]
    (run,) = found.of("t_test", "toe")
    total = sum(float(row[1]) for row in table.rows)
    assert total == pytest.approx(np.mean(run.end_times), abs=0.2)
    assert "16.06 s" in table.caption


def test_without_a_kept_run_only_the_animation_is_missing(found, draw):
    light = dataclasses.replace(found, evaluations=[e.light(0) for e in found.evaluations])
    content = table_four(light, draw).content
    assert [picture.file for picture in of_kind(content, Picture)] == ["figures/ways_t_test.png"]
    assert "stretch" in [table.headers[0] for table in of_kind(content, Table)]
