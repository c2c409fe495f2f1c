import math

import numpy as np
import pytest
from diagnosed import run
from robots import with_torque_sensors

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.strength import motor_strengths
from hyperleg_design.gap.inference.nuisance import TORQUE_ZERO
from hyperleg_design.gap.inference.samples import gather
from hyperleg_design.gap.inference.zeros import OF_TORQUE, OFFSET, Zeros
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.filtering import filtered_log
from hyperleg_design.gap.signals.loading import load_subject

SPREAD = np.array([[0.02, 0.05], [0.03, 0.0], [0.0, 0.04]])


@pytest.fixture(scope="module")
def logs(robot_files):
    subject = load_subject(robot_files["coupled"])
    return [filtered_log(condition(run("healthy", seed), subject)) for seed in range(2)]


@pytest.fixture
def zeros(logs):
    names = tuple((OFFSET, joint) for joint in logs[0].signals.subject.joints)
    return Zeros(names, SPREAD, tests=2)


def test_it_is_the_effect_of_encoders():
    assert EFFECTS[OFFSET].kind == "joint"


def test_each_log_has_its_own_columns(logs, zeros):
    floors = [[np.ones(log.count(row)) for row in range(len(log.rows))] for log in logs]
    samples = gather(logs, floors, [0, 1], 1.0)
    columns = zeros.columns(logs, samples, tested=True)
    assert len(columns) == np.count_nonzero(SPREAD)
    first = samples.log[samples.part] == 0
    shown = [(bool(c[first].any()), bool(c[~first].any())) for c in columns]
    assert shown == [(True, False), (True, False), (False, True), (False, False)]
    references = zeros.columns(logs[:1], gather(logs[:1], floors[:1], [0], 1.0), tested=False)
    assert [bool(c.any()) for c in references] == [False, False, False, True]


def test_usual_errors_of_encoders_grow_by_what_all_tests_have(zeros):
    usual = {("viscous_friction", "hip", 0): 0.1, (OFFSET, "hip", 0): 0.003}
    usual[OFFSET, "knee", 0] = 0.003
    larger = zeros.usual_with(usual)
    assert larger["viscous_friction", "hip", 0] == 0.1
    assert larger[OFFSET, "hip", 0] == pytest.approx(math.hypot(0.003, 0.02))
    assert larger[OFFSET, "knee", 0] == 0.003


def test_torque_sensors_have_zeros_whose_motors_seem_to_give_what_joints_do_not_need(robot_files):
    subject = load_subject(robot_files["coupled"], [with_torque_sensors(run("healthy", 0))])
    sensed, plain = (
        condition(log, subject)
        for log in (with_torque_sensors(run("healthy", 0)), run("healthy", 1))
    )
    zeros = Zeros.of([sensed], [plain], subject)
    spread = dict(zip(zeros.names, zeros.spread.T.tolist(), strict=True))
    for motor, strength in zip(subject.motors, motor_strengths(subject), strict=True):
        assert spread[TORQUE_ZERO, motor] == [pytest.approx(OF_TORQUE * strength), 0.0]
    assert not any(spread[OFFSET, joint][1] for joint in subject.joints)
    log = filtered_log(sensed)
    samples = gather([log], [[np.ones(log.count(row)) for row in range(len(log.rows))]], [0], 1.0)
    columns = zeros.columns([log], samples, tested=True)
    shown = np.array(
        [
            [bool(column[where[row]].any()) for row in range(len(log.rows))]
            for column in columns
            for where in samples.where
        ]
    )
    kinds = [row.residual_name for row in log.rows]
    assert len(columns) == 2
    for own in shown:
        motions = [s for s, kind in zip(own, kinds, strict=True) if kind == "motion"]
        drives = [s for s, kind in zip(own, kinds, strict=True) if kind == "drive"]
        assert motions == [True, True]  # both joints are moved by either motor
        assert sum(drives) == 1
