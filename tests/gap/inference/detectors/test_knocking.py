"""Joints that knock about in their play unseen, on an arm of two links that is written here:
textbook dynamics, rotors on stiff springs.
"""

from functools import cache

import numpy as np
import pytest
from two_links import DAMPING, GAINS, JOINTS, LOSS, MJCF, RATE, ROTOR, STEP, STIFF, mass_and_bias

from hyperleg_design.gap.inference.detectors.knocking import knocking, struck
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject


@cache
def arm(play=(0.0, 0.0), bumps=0.0, seed=0, role="test", seconds=10):
    """A log with encoders on the rotors; `bumps` are torques that hit the elbow now and then
    [Nm].
    """
    rng = np.random.default_rng(seed)
    phase = rng.uniform(0, 2 * np.pi, 4)
    stiffness, damping = (np.array([GAINS[j][k] for j in JOINTS]) for k in (0, 1))
    rotor = np.array(
        [
            -1.2 + 0.3 * np.sin(phase[0]) + 0.2 * np.sin(phase[1]),
            0.5 + 0.3 * np.sin(phase[2]) + 0.2 * np.sin(phase[3]),
        ]
    )
    joint, turning, moving = rotor.copy(), np.zeros(2), np.zeros(2)
    hits = np.sort(rng.uniform(0, seconds, 25))
    rows = []
    for i in range(round(seconds / STEP)):
        t = i * STEP
        w = 2 * np.pi * t
        target = np.array(
            [
                -1.2 + 0.3 * np.sin(0.5 * w + phase[0]) + 0.2 * np.sin(1.3 * w + phase[1]),
                0.5 + 0.3 * np.sin(0.7 * w + phase[2]) + 0.2 * np.sin(1.7 * w + phase[3]),
            ]
        )
        torque = stiffness * (target - rotor) - damping * turning
        if i % round(1 / RATE / STEP) == 0:
            rows.append(np.r_[t, target, rotor, turning, torque])
        stretch = rotor - joint
        taut = stretch - np.clip(stretch, -np.array(play) / 2, np.array(play) / 2)
        pull = STIFF * taut + DAMPING * (turning - moving) * ((taut != 0) | (np.array(play) == 0))
        mass, bias = mass_and_bias(joint, moving)
        bump = bumps * (np.abs(t - hits).min() < 0.02)
        pushed = pull - bias + np.array([0.0, bump])
        turning = turning + STEP * (torque - pull - LOSS * np.tanh(turning / 0.02)) / ROTOR
        moving = moving + STEP * np.linalg.solve(mass, pushed)
        rotor, joint = rotor + STEP * turning, joint + STEP * moving
    table = np.array(rows)
    noise = rng.normal(size=(len(table), 4))
    signals = {}
    for j, name in enumerate(JOINTS):
        signals[f"position_target/{name}"] = table[:, 1 + j]
        signals[f"position/{name}"] = np.round(table[:, 3 + j] + 3e-5 * noise[:, j], 5)
        signals[f"velocity/{name}"] = table[:, 5 + j] + 3e-3 * noise[:, 2 + j]
        signals[f"motor_torque/{name}"] = table[:, 7 + j]
    return Log(f"{role}_{seed}", table[:, 0], signals, Metadata(gains=GAINS, role=role))


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(MJCF)
    return path


def heard(robot, *logs, references=()):
    subject = load_subject(robot, list(logs))
    return knocking(
        [condition(one, subject) for one in logs], [condition(one, subject) for one in references]
    )


def test_the_model_is_the_same_arm(robot):
    import mujoco

    model = mujoco.MjModel.from_xml_string(MJCF)
    data = mujoco.MjData(model)
    q, v = np.array([-1.0, 0.7]), np.array([0.4, -1.1])
    data.qpos, data.qvel = q, v
    mujoco.mj_forward(model, data)
    full = np.zeros((2, 2))
    mujoco.mj_fullM(model, data, full)
    mass, bias = mass_and_bias(q, v)
    np.testing.assert_allclose(full, mass + ROTOR * np.eye(2), rtol=1e-9)
    np.testing.assert_allclose(data.qfrc_bias, bias, rtol=1e-9)


@pytest.mark.parametrize("place", [0, 1])
def test_the_joint_that_has_play_is_told_by_the_other_one(robot, place):
    play = tuple(0.02 * (i == place) for i in range(2))
    found = heard(
        robot, arm(play, seed=1), arm(play, seed=2), references=[arm(seed=3, role="reference")]
    )
    assert found.location == JOINTS[place]
    assert found.closed_interval[0] <= found.closed <= found.closed_interval[1]
    angle = next(c for c in found.causes if c.effect == "backlash").parameters["angle"]
    assert angle.low < 0.02 < angle.high
    assert found.causes[0].parameters["side"].value == 1.0


def test_healthy_arms_do_not_knock(robot):
    assert heard(robot, arm(seed=1), arm(seed=2)) is None


def test_a_hidden_motion_explains_both_joints_where_it_knocks_hardest(robot):
    log = arm((0.0, 0.02), seed=1)
    time, left, explained = struck(condition(log, load_subject(robot, [log])), "elbow")
    assert len(time) == len(left) == len(explained)
    assert np.sum((left - explained) ** 2) < 0.2 * np.sum(left**2)
    assert (np.sum(explained**2, 0) > 0.1 * np.sum(explained**2)).all()


def test_torques_that_hit_one_joint_are_no_play(robot):
    assert heard(robot, arm(bumps=3.0, seed=1), arm(bumps=3.0, seed=2)) is None


def test_what_reference_logs_show_too_is_nothing_new(robot):
    play = (0.0, 0.02)
    assert (
        heard(
            robot,
            arm(play, seed=1),
            arm(play, seed=2),
            references=[arm(play, seed=3, role="reference")],
        )
        is None
    )


@pytest.mark.parametrize("every", [4, 10, 20])
def test_slow_logs_hear_no_knocks(robot, every):
    whole = arm((0.0, 0.02), seed=1)
    log = Log(
        "slow",
        whole.time[::every],
        {k: v[::every] for k, v in whole.signals.items()},
        whole.metadata,
    )
    found = heard(robot, log)
    assert found is None or (every == 4 and found.location == "elbow")


def test_one_joint_alone_has_nothing_to_tell_motion_from_torque_by(tmp_path):
    path = tmp_path / "one.xml"
    path.write_text(
        MJCF[: MJCF.index('<body name="fore"')]
        + '</body></worldbody><actuator><motor name="shoulder" '
        'joint="shoulder"/></actuator></mujoco>'
    )
    whole = arm((0.02, 0.0), seed=1)
    own = {k: v for k, v in whole.signals.items() if k.endswith("shoulder")}
    assert (
        heard(path, Log("one", whole.time, own, Metadata(gains={"shoulder": GAINS["shoulder"]})))
        is None
    )


def test_the_diagnosis_says_so(robot):
    play = (0.0, 0.02)
    logs, references = (
        [arm(play, seed=1), arm(play, seed=2)],
        [arm(seed=s, role="reference") for s in (3, 4)],
    )
    found = diagnose(robot, logs, references, threads=1)
    assert found.verdict == "ambiguous"
    assert (found.causes[0].effect, found.causes[0].location) == ("backlash", "elbow")


def test_another_cause_is_named_beside_it(robot):
    """A shoulder whose drive tells 1.3 times its torque, and an elbow with play."""
    plain = [arm((0.0, 0.02), seed=s) for s in (1, 2)]
    logs = [
        log.changed(
            signals={
                **log.signals,
                "motor_torque/shoulder": 1.3 * log.column("motor_torque/shoulder"),
            }
        )
        for log in plain
    ]
    found = diagnose(robot, logs, [arm(seed=s, role="reference") for s in (3, 4)], threads=1)
    assert {c.location for c in found.causes} == {"shoulder", "elbow"}
    (play,) = [c for c in found.causes if c.location == "elbow"]
    assert play.effect == "backlash"
    assert play.parameters["angle"].value == pytest.approx(0.02, rel=0.5)
    assert min(c.probability for c in found.causes) > 0
    assert found.gap.closed > 0.5
