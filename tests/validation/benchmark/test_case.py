"""Cases of the benchmark: their kinds, the changes of recordings, and the files of a diagnosis."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import read_log
from hyperleg_design.validation.benchmark.case import (
    KINDS,
    Case,
    Fault,
    Material,
    Recording,
    Truth,
    labelled,
    write_case,
)

TIME = np.linspace(0, 2, 201)
LOG = Recording(
    "a",
    TIME,
    {"position/hip": 3 * TIME, "position_target/hip": 2 * TIME, "motor_torque/hip": 1 + TIME},
    {"base": "fixed"},
)
FAULT = Fault("payload", ("hand", "wrist"))
STRANGE = Fault("gremlin", (), listed=False)


@pytest.mark.parametrize(
    ("faults", "everywhere", "kind"),
    [
        ((), False, "nothing"),
        ((FAULT,), False, "single"),
        ((FAULT, FAULT), True, "everywhere"),
        ((FAULT, FAULT), False, "several"),
        ((FAULT, STRANGE), True, "outside"),
        ((STRANGE,), False, "outside"),
    ],
)
def test_the_kind_of_a_case_follows_from_its_faults(faults, everywhere, kind):
    assert Truth(faults, everywhere=everywhere).kind == kind
    assert kind in KINDS


def test_faults_in_words():
    assert str(Truth((FAULT, STRANGE))) == "payload at hand, gremlin"
    assert str(Truth()) == "nothing"
    with pytest.raises(InputError, match="at least one place"):
        Fault("payload", ())


@given(st.floats(0.0, 1.0))
def test_a_signal_told_early_is_the_signal_of_later(seconds):
    early = LOG.early(seconds, "position")
    np.testing.assert_allclose(early.signals["position/hip"], 3 * (early.time + seconds))
    np.testing.assert_array_equal(early.signals["position_target/hip"], 2 * early.time)
    assert early.time[-1] <= 2 - seconds


@given(st.floats(0, 2), st.floats(0, 2))
def test_a_part_holds_the_rows_between_its_ends(first, second):
    begin, end = sorted((first, second))
    part = LOG.part(begin, end)
    inside = (begin <= TIME) & (end >= TIME)
    np.testing.assert_array_equal(part.time, TIME[inside])
    np.testing.assert_array_equal(part.signals["position/hip"], 3 * TIME[inside])


def test_changes_leave_the_recording_as_it_was():
    before = {name: values.copy() for name, values in LOG.signals.items()}
    scaled = LOG.scaled(2.0, "position/hip", "position/elbow")
    np.testing.assert_array_equal(scaled.signals["position/hip"], 6 * TIME)
    assert "position/elbow" not in scaled.signals
    shifted = LOG.shifted(0.5, "motor_torque/hip")
    np.testing.assert_array_equal(shifted.signals["motor_torque/hip"], 1.5 + TIME)
    assert set(LOG.without("position").signals) == {"position_target/hip", "motor_torque/hip"}
    assert labelled([LOG], notes="x")[0].metadata == {"base": "fixed", "notes": "x"}
    assert LOG.metadata == {"base": "fixed"}
    for name, values in LOG.signals.items():
        np.testing.assert_array_equal(values, before[name])
    with pytest.raises(InputError, match="position/elbow"):
        LOG.shifted(0.5, "position/elbow")


@pytest.mark.parametrize(
    ("key", "value"),
    [("suite", "unreal"), ("split", "half"), ("kind", "odd"), ("name", "a/b"), ("name", "")],
)
def test_a_case_that_cannot_be_is_refused(key, value):
    good = {"name": "a-1_b", "suite": "real", "split": "held out", "kind": "single"}
    Case(**good, about="", build=lambda data: None)
    with pytest.raises(InputError, match=key):
        Case(**{**good, key: value}, about="", build=lambda data: None)


def test_the_files_of_a_case_are_read_back_and_hold_no_truth(tmp_path):
    xml = "  <mujoco model='a'/>"
    folder = write_case(Material(xml, (LOG, LOG), (LOG,)), tmp_path / "case")
    entry = json.loads((folder / "case.json").read_text())
    assert set(entry) == {"robot", "logs", "references"}
    assert (folder / entry["robot"]).read_text() == xml
    assert (len(entry["logs"]), len(entry["references"])) == (2, 1)
    for group, role in (("logs", "test"), ("references", "reference")):
        log = read_log(folder / entry[group][0])
        np.testing.assert_array_equal(log.time, TIME)
        np.testing.assert_array_equal(log.column("position/hip"), 3 * TIME)
        assert (log.metadata.role, log.metadata.base) == (role, "fixed")


def test_a_robot_by_name_stays_a_name(tmp_path):
    folder = write_case(Material("hyperleg", ()), tmp_path / "case")
    assert json.loads((folder / "case.json").read_text())["robot"] == "hyperleg"
    assert not (folder / "robot.xml").exists()
