"""Belts that ring, against a pendulum on a belt that is written here: two masses, a controller at 1
kHz, none of the package's physics.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from hyperleg_design.gap.inference.detectors.loose import loose
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject

MJCF = """<mujoco><worldbody><body name="arm">
<joint name="hinge" type="hinge" axis="0 1 0" armature="0.02" damping="0.02" frictionloss="0.05"/>
<inertial pos="0 0 -0.15" mass="0.3" diaginertia="0.04 0.04325 0.04"/></body></worldbody>
<actuator><motor name="hinge" joint="hinge" ctrlrange="-6 6"/></actuator></mujoco>"""
INERTIA, ROTOR, LIMIT, STEP, RATE, STIFFNESS, DAMPING = 0.05, 0.02, 6.0, 1e-4, 200, 60.0, 3.0
RIGID = 1e5


@cache
def recorded(spring=RIGID, play=0.0, delay=1, damping=DAMPING, seconds=10):
    """Time, target, angle, speed and motor torque, in the joint's units, at 200 Hz."""
    place, speed = np.zeros(2), np.zeros(2)
    asked, rows = [0.0] * (delay + 1), []
    loss = 0.06 * np.sqrt(spring * ROTOR)
    for i in range(round(seconds / STEP)):
        time = i * STEP
        target = 0.4 * np.sin(2 * np.pi * 0.4 * time) + 0.15 * np.sin(2 * np.pi * 1.3 * time)
        if i % 10 == 0:
            asked.append(
                float(np.clip(STIFFNESS * (target - place[1]) - damping * speed[1], -LIMIT, LIMIT))
            )
        torque = asked[-1 - delay]
        if i % round(1 / RATE / STEP) == 0:
            rows.append((time, target, place[1], speed[1], torque))
        stretch = place[0] - place[1]
        taut = stretch - min(max(stretch, -play / 2), play / 2)
        pull = spring * taut + (loss * (speed[0] - speed[1]) if taut or not play else 0.0)
        held = (
            0.05 * np.tanh(speed[1] / 0.02) + 0.02 * speed[1] + 9.81 * 0.3 * 0.15 * np.sin(place[1])
        )
        speed = speed + STEP * np.array([(torque - pull) / ROTOR, (pull - held) / INERTIA])
        place = place + STEP * speed
    return np.array(rows)[RATE:].T


def log(rows, *, velocity=True, torque=True, every=1, role="test", damping=DAMPING):
    time, target, angle, speed, given = rows[:, ::every]
    noise = np.random.default_rng(0).normal(size=(2, len(time)))
    signals = {
        "position_target/hinge": target,
        "position/hinge": np.round(angle + 5e-5 * noise[0], 4),
    }
    if torque:
        signals["motor_torque/hinge"] = given
    if velocity:
        signals["velocity/hinge"] = speed + 5e-3 * noise[1]
    return Log(role, time, signals, Metadata(gains={"hinge": (STIFFNESS, damping)}, role=role))


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "pendulum.xml"
    path.write_text(MJCF)
    return path


def belt(robot, *rows, **options):
    logs = [log(one, **options) for one in rows]
    subject = load_subject(robot, logs)
    return loose([condition(one, subject) for one in logs])


@pytest.mark.parametrize("velocity", [True, False])
def test_stiffness_of_a_soft_belt_follows_from_its_ringing(robot, velocity):
    found = belt(robot, recorded(spring=2000.0), velocity=velocity)
    assert found.location == "hinge"
    first, second = found.causes
    assert (first.effect, second.effect) == ("transmission_elasticity", "backlash")
    stiffness = first.parameters["stiffness"]
    assert stiffness.low < 2000 < stiffness.high
    assert stiffness.value == pytest.approx(2000, rel=0.1)
    assert found.closed > 0.9


@pytest.mark.parametrize("play", [0.006, 0.012])
def test_width_of_a_play_follows_from_how_far_the_rotor_swings(robot, play):
    first, second = belt(robot, recorded(spring=2e4, play=play)).causes
    assert (first.effect, second.effect) == ("backlash", "transmission_elasticity")
    angle = first.parameters["angle"]
    assert angle.low < play < angle.high
    assert angle.value == pytest.approx(play, rel=0.25)


def test_a_line_that_the_rate_folds_is_unfolded_by_speed_over_swing(robot):
    rows = recorded(spring=2000.0)
    whole, folded = belt(robot, rows), belt(robot, rows, every=2)
    assert whole.frequency > 50  # above half the lower rate
    assert folded is None or folded.frequency == pytest.approx(whole.frequency, rel=0.1)


@pytest.mark.parametrize("torque", [True, False])
def test_a_late_command_makes_a_stiff_joint_chatter_and_is_no_belt(robot, torque):
    logs = [log(recorded(delay=3, damping=40.0), damping=40.0, torque=torque)]
    signals = condition(logs[0], load_subject(robot, logs))
    assert signals.limit_cycle is not None
    assert signals.limit_cycle.joints.all()
    assert loose([signals]) is None


def test_nothing_rings_on_a_stiff_belt(robot):
    assert belt(robot, recorded()) is None


def test_what_friction_may_hold_is_no_belts(robot, tmp_path):
    sticky = tmp_path / "sticky.xml"
    sticky.write_text(MJCF.replace('frictionloss="0.05"', 'frictionloss="500"'))
    rows = recorded(spring=2000.0)
    assert belt(robot, rows).size < 500
    assert belt(sticky, rows) is None


def test_what_rang_before_is_no_news(robot):
    signals = condition(
        log(recorded(spring=2000.0)), load_subject(robot, [log(recorded(spring=2000.0))])
    )
    known = replace(signals, limit_cycle=replace(signals.limit_cycle, joints=np.zeros(1, bool)))
    assert loose([signals]) is not None
    assert loose([known]) is None
    assert (
        loose([replace(signals, subject=replace(signals.subject, base="floating"))]) is None
    )  # on its feet, nothing is known


def test_a_diagnosis_names_the_belt_and_how_to_tell_play_from_softness(robot):
    test = log(recorded(spring=2000.0))
    found = diagnose(robot, [test], [log(recorded(), role="reference")], threads=1)
    assert found.verdict == "ambiguous"
    assert [(c.effect, c.location) for c in found.causes] == [("transmission_elasticity", "hinge")]
    assert found.equivalent == ((("transmission_elasticity", "hinge"), ("backlash", "hinge")),)
    assert found.separating_experiment["name"] == "several amplitudes"
    assert found.residual_shape[0]["shape"] == "ringing"
    assert found.gap.closed == pytest.approx(1 - found.gap.after / found.gap.before)
    assert found.causes[0].probability > 0.5
    assert sum(c.probability for c in (*found.causes, *found.rivals)) < 1 + 1e-9
