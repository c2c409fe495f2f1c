"""What all readers share: side files, names of joints, and clocks that count from the epoch."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.readers.source import beside, build_log, joint_names, side_file


def test_the_side_file_of_a_folder_a_table_and_a_json_file(tmp_path):
    assert side_file(tmp_path) == tmp_path / "hyperleg.json"
    assert side_file(Path("a/run.csv")) == Path("a/run.json")
    assert side_file(Path("a/run.json")) == Path("a/run.meta.json")


def test_the_side_file_of_a_folder_may_lie_beside_it(tmp_path):
    folder, beside_it = tmp_path / "run_1", tmp_path / "run_1.json"
    folder.mkdir()
    beside_it.write_text("{}")
    assert side_file(folder) == beside_it
    (folder / "hyperleg.json").write_text("{}")
    assert side_file(folder) == folder / "hyperleg.json"


def test_what_is_given_to_the_reader_goes_before_the_side_file(tmp_path):
    source = tmp_path / "run.csv"
    assert beside(source, None) == {}
    (tmp_path / "run.json").write_text(json.dumps({"base": "fixed", "session": "a"}))
    assert beside(source, {"session": "b"}) == {"base": "fixed", "session": "b"}


def test_joints_are_renamed_in_the_order_of_the_source():
    assert joint_names({}, ["q0", "q1"], "run") == ["q0", "q1"]
    assert joint_names({"joints": ["hip", "knee"]}, ["q0", "q1"], "run") == ["hip", "knee"]
    for names in (["hip"], "hip", ["hip", 3], ["hip", "hip"]):
        with pytest.raises(InputError, match="joints"):
            joint_names({"joints": names}, ["q0", "q1"], "run")


def test_a_clock_from_the_epoch_begins_at_zero_and_its_start_is_kept(tmp_path):
    time = 1.7e9 + np.arange(50) * 0.01
    signals = {"position/j": np.sin(np.arange(50) * 0.1)}
    log = build_log(
        tmp_path / "run.csv", "run", time, signals, {"base": "fixed"}, {}, ["converted"]
    )
    assert log.time[0] == 0.0
    np.testing.assert_allclose(np.diff(log.time), 0.01, atol=1e-6)
    assert log.metadata.extra["start_time"] == 1.7e9
    assert "converted" in log.metadata.remarks
    later = build_log(tmp_path / "run.csv", "run", time - 1.7e9 + 5, signals, {}, {}, [])
    assert later.time[0] == pytest.approx(5.0)
    assert "start_time" not in later.metadata.extra


def test_what_the_user_states_goes_before_what_the_source_states(tmp_path):
    time, signals = np.arange(50) * 0.01, {"position/j": np.zeros(50)}
    source_metadata, user_metadata = (
        {"base": "fixed", "session": "source"},
        {"session": "user", "units": {}},
    )
    log = build_log(tmp_path / "run.csv", "run", time, signals, source_metadata, user_metadata, [])
    assert (log.metadata.base, log.metadata.session) == ("fixed", "user")
    assert "units" not in log.metadata.extra
