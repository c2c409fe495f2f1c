"""Logs that no diagnosis can use are refused by the check."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import robots
from rig import rig_log, spoiled

from hyperleg_design.gap.checks.check import check_log
from hyperleg_design.gap.checks.rules import RULES
from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture(scope="module")
def log():
    return rig_log()


def errors(log, subject=None):
    return [(f.signal, f.what) for f in check_log(log, subject).errors]


def test_three_ticks(log):
    found = errors(log.part(slice(0, 3)))
    assert ("t", "has 3 ticks, too few for velocities and accelerations") in found
    assert not [e for e in errors(log.part(slice(0, RULES.clock.fewest))) if "ticks" in e[1]]


def test_a_position_without_values(log):
    empty = spoiled(log, position__knee=np.full(len(log.time), np.nan))
    assert errors(empty) == [("position/knee", "holds no values")]


def test_torques_without_values_count_as_missing(log):
    nothing = np.full(len(log.time), np.nan)
    names = {
        f"{kind}__{joint}": nothing
        for kind in ("motor_torque_command", "motor_torque", "motor_current", "position_target")
        for joint in ("hip", "knee")
    }
    assert ("", "neither targets nor torques nor currents") in errors(spoiled(log, **names))


@pytest.mark.parametrize("factor", [1e9, 1e6])
def test_a_torque_in_another_unit(log, factor):
    large = spoiled(log, motor_torque__hip=factor * log.column("motor_torque/hip"))
    assert [signal for signal, what in errors(large) if "no such torque" in what] == [
        "motor_torque/hip"
    ]


def test_a_torque_far_beyond_the_drive(tmp_path):
    path = tmp_path / "servos.xml"
    path.write_text(robots.COUPLED)
    subject = load_subject(path)
    target = robots.waves(2, [1.5, 1.5], seed=0)
    log = robots.servo_run(robots.COUPLED, target, 4.0)
    assert not errors(log, subject)
    thousand = log.changed(
        signals={c: 1000 * v if c == "motor_torque/m_front" else v for c, v in log.signals.items()}
    )
    assert any("times the drive's 4 Nm" in what for _, what in errors(thousand, subject))


def test_joints_that_the_robot_does_not_have(tmp_path):
    path = tmp_path / "servos.xml"
    path.write_text(robots.COUPLED)
    log = robots.servo_run(robots.COUPLED, robots.waves(2, [1.0, 1.0], seed=0), 4.0)
    renamed = log.changed(
        signals={c.replace("/knee", "/kne"): v for c, v in log.signals.items()},
        metadata=replace(log.metadata, gains={}),
    )
    found = errors(renamed, load_subject(path))
    assert any("joints that the robot does not have: kne (knee?)" in what for _, what in found)
