from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from robots import PENDULUM, servo_run, waves

from hyperleg_design.errors import InputError
from hyperleg_design.gap.checks.intake import take_in
from hyperleg_design.gap.logs.log import write_log
from hyperleg_design.gap.playback.measure import measure
from hyperleg_design.report.gap.text import gap_text


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("rig")
    (place / "pendulum.xml").write_text(PENDULUM)
    heavy = PENDULUM.replace('mass="0.5"', 'mass="0.7"')
    write_log(
        place / "clean.parquet",
        servo_run(PENDULUM, waves(1, 1.0), 6.0, base="fixed", role="reference"),
    )
    write_log(place / "heavy.parquet", servo_run(heavy, waves(1, 1.0, seed=1), 6.0, base="fixed"))
    return place


def test_logs_that_say_so_are_references(folder: Path) -> None:
    found = take_in(
        str(folder / "pendulum.xml"), [folder / "heavy.parquet", folder / "clean.parquet"]
    )
    assert [len(found.tests), len(found.references)] == [1, 1]
    assert found.tests[0].subject.joints == ("swing",)
    gap = measure(found.tests, found.references)
    (row,) = gap.select("torque")
    gravity = 0.2 * 9.81 * 0.1 * np.sin(np.nanmax(np.abs(found.tests[0].position)))
    assert row.floor < 0.1 * row.gap < gravity
    text = gap_text(gap)
    assert "swing" in text
    assert "reference logs" in text


def test_a_recording_counts_once(folder: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy.parquet"
    copy.write_bytes((folder / "heavy.parquet").read_bytes())
    heavy, clean = folder / "heavy.parquet", folder / "clean.parquet"
    for sources, references in (([heavy, copy], []), ([heavy], [copy]), ([heavy], [clean, clean])):
        with pytest.raises(InputError, match="each recording counts once"):
            take_in(str(folder / "pendulum.xml"), sources, references)
    assert len(take_in(str(folder / "pendulum.xml"), [heavy], [clean]).references) == 1


def test_nothing_to_test_is_told(folder: Path) -> None:
    robot = str(folder / "pendulum.xml")
    with pytest.raises(InputError, match="are all references"):
        take_in(robot, [folder / "clean.parquet"])
    with pytest.raises(InputError, match="expects files or folders"):
        take_in(robot, [])
    with pytest.raises(InputError):
        take_in("hyperleg", [folder / "heavy.parquet"])
