"""Cases that a seed draws: what the truth says is in the files, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.validation.real.a0 import DEVELOPMENT, FOLDER, MODEL, read_recording
from hyperleg_design.validation.real.a0_model import JOINTS, LINKS, read_model
from hyperleg_design.validation.real.cases import data_folder
from hyperleg_design.validation.real.drawn import (
    CHANGES,
    COUNT,
    SIZES,
    drawn,
    drawn_cases,
    material,
)

DATA = data_folder()
logged = pytest.mark.skipif(not (DATA / FOLDER).is_dir(), reason="the real logs are not there")


def test_the_same_number_draws_the_same_case_from_recordings_for_development_alone():
    for number in range(COUNT):
        one = drawn(number)
        assert one == drawn(number)
        assert {*one.tests, *one.references} <= DEVELOPMENT
        assert not set(one.tests) & set(one.references)
        for kind, place, size in zip(one.kinds, one.places, one.sizes, strict=False):
            low, high = SIZES[kind][place]
            assert low <= abs(size) <= high


def test_names_are_unique_and_all_kinds_are_there():
    cases = drawn_cases()
    assert len({case.name for case in cases}) == COUNT
    assert {case.kind for case in cases} == {"nothing", "single", "several", "outside"}
    assert {case.split for case in cases} == {"development"}


@logged
@pytest.mark.parametrize("kind", sorted(CHANGES))
def test_a_fault_changes_the_columns_of_its_joint_alone(kind):
    log = read_recording(DATA / FOLDER, "sys_id/trajectory_03")
    size = SIZES[kind][1][1]
    _, change = CHANGES[kind](1, size, 0.5)
    changed = change(log)
    assert changed.signals.keys() == log.signals.keys()
    if kind == "delay":
        assert changed.time[-1] == pytest.approx(log.time[-1] - size, abs=0.01)
        return
    touched = {c for c in log.signals if np.any(changed.signals[c] != log.signals[c])}
    torques = {f"motor_torque/{JOINTS[1]}", f"motor_torque_command/{JOINTS[1]}"}
    assert touched == ({f"position/{JOINTS[1]}"} if kind == "encoder" else torques)


@logged
def test_a_load_is_told_to_those_logs_alone_that_have_what_they_are_told():
    nominal = read_model(DATA / FOLDER / MODEL).mjcf()
    loads = [n for n in range(COUNT) if drawn(n).kinds == ("load",) and drawn(n).references]
    assert {drawn(n).sizes[0] > 0 for n in loads} == {True, False}
    for number in loads:
        one, (files, truth) = drawn(number), material(DATA, number)
        told = [bool(log.metadata.get("payload")) for log in (*files.logs, *files.references)]
        tests = len(files.logs)
        lacking = one.sizes[0] > 0
        assert told == [not lacking] * tests + [lacking] * len(files.references)
        assert (files.robot == nominal) is not lacking
        assert truth.faults[0].places == (LINKS[one.places[0]], JOINTS[one.places[0]])
