"""What makes loops swing, against a two-link arm that is written here: its equations, a controller
at 1 kHz, a belt of two masses.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from hyperleg_design.gap.inference.detectors.unstable import swinging, unstable
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject

MASS, CENTRE, SPIN, LENGTH, ROTORS = (
    (1.2, 0.6),
    (0.15, 0.12),
    (0.02, 0.006),
    0.3,
    np.array([0.02, 0.01]),
)
FRICTION, DAMPING, STEP, RATE, LIMIT = 0.05, 0.02, 2e-4, 200, 8.0
MJCF = f"""<mujoco><option gravity="0 0 0"/><worldbody><body name="upper">
<joint name="shoulder" type="hinge" axis="0 0 1" armature="{ROTORS[0]}" damping="{DAMPING}" frictionloss="{FRICTION}"/>
<inertial pos="{CENTRE[0]} 0 0" mass="{MASS[0]}" diaginertia="0.001 {SPIN[0]} {SPIN[0]}"/><body name="lower" pos="{LENGTH} 0 0">
<joint name="elbow" type="hinge" axis="0 0 1" armature="{ROTORS[1]}" damping="{DAMPING}" frictionloss="{FRICTION}"/>
<inertial pos="{CENTRE[1]} 0 0" mass="{MASS[1]}" diaginertia="0.0005 {SPIN[1]} {SPIN[1]}"/></body></body></worldbody>
<actuator><motor name="shoulder" joint="shoulder" ctrlrange="-{LIMIT} {LIMIT}"/>
<motor name="elbow" joint="elbow" ctrlrange="-{LIMIT} {LIMIT}"/></actuator></mujoco>"""  # noqa: E501
CALM, TIGHT = ((60.0, 3.0), (25.0, 1.2)), ((60.0, 3.0), (25.0, 8.0))
"""Stiffness and damping of both joints."""
JOINTS = ("shoulder", "elbow")


@cache
def recorded(gains, late=1, spring=None, seconds=6):
    """Time, targets, angles, speeds and torques at 200 Hz; `late` milliseconds, the elbow's motor
    on a belt where a spring is given.
    """
    stiffness, damping = np.array(gains).T
    angle, speed, rotor, spin = np.zeros(2), np.zeros(2), 0.0, 0.0
    asked, rows = [np.zeros(2)] * (late + 1), []
    coupling, lower = MASS[1] * LENGTH * CENTRE[1], SPIN[1] + MASS[1] * CENTRE[1] ** 2
    upper = SPIN[0] + MASS[0] * CENTRE[0] ** 2 + MASS[1] * LENGTH**2 + lower
    phases = 2 * np.pi * np.array([[0.4, 0.5], [1.1, 1.3]])
    for i in range(round(seconds / STEP)):
        time = i * STEP
        target = np.array([0.5, 0.2]) @ np.sin(phases * time + [[0.0, 1.0], [0.0, 0.0]])
        if i % round(1e-3 / STEP) == 0:
            asked.append(np.clip(stiffness * (target - angle) - damping * speed, -LIMIT, LIMIT))
        torque = asked[-1 - late]
        if i % round(1 / RATE / STEP) == 0:
            rows.append(np.concatenate([[time], target, angle, speed, torque]))
        bent, turned = coupling * np.cos(angle[1]), coupling * np.sin(angle[1])
        mass = np.array([[upper + 2 * bent, lower + bent], [lower + bent, lower]])
        force = torque - FRICTION * np.tanh(speed / 0.02) - DAMPING * speed
        force = force + turned * np.array(
            [2 * speed[0] * speed[1] + speed[1] ** 2, -(speed[0] ** 2)]
        )
        mass[0, 0] += ROTORS[0]
        if spring is None:
            mass[1, 1] += ROTORS[1]
        else:
            pull = spring * (rotor - angle[1]) + 0.06 * np.sqrt(spring * ROTORS[1]) * (
                spin - speed[1]
            )
            force[1] += pull - torque[1]
            spin += STEP * (torque[1] - pull) / ROTORS[1]
            rotor += STEP * spin
        speed = speed + STEP * np.linalg.solve(mass, force)
        angle = angle + STEP * speed
    return np.array(rows)[RATE:].T


def log(gains, role="test", **options):
    """Positions and speeds with noise; nobody measures what the motors give."""
    rows = recorded(gains, **options)
    noise = np.random.default_rng(0).normal(size=(4, rows.shape[1]))
    signals = {}
    for i, joint in enumerate(JOINTS):
        signals |= {
            f"position_target/{joint}": rows[1 + i],
            f"position/{joint}": rows[3 + i] + 2e-5 * noise[i],
            f"velocity/{joint}": rows[5 + i] + 5e-3 * noise[2 + i],
        }
    return Log(
        role,
        rows[0],
        signals,
        Metadata(gains=dict(zip(JOINTS, gains, strict=True)), role=role, gravity=(0.0, 0.0, 0.0)),
    )


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(MJCF)
    return path


def heard(robot, *logs):
    subject = load_subject(robot, logs)
    return unstable([condition(one, subject) for one in logs])


@pytest.mark.parametrize("spring", [400.0, 1000.0])
def test_a_soft_belt_is_known_by_the_joints_that_swing_and_its_stiffness_by_their_frequency(
    robot, spring
):
    found = heard(robot, log(CALM, spring=spring))
    assert {(c.effect, c.location) for c in found.causes} == {
        ("transmission_elasticity", "elbow"),
        ("backlash", "elbow"),
    }
    assert found.causes[0].effect == "transmission_elasticity"
    compliance = found.causes[0].parameters["compliance"]
    assert compliance.low < 1 / spring < compliance.high
    assert compliance.value == pytest.approx(1 / spring, rel=0.4)
    assert found.closed > 0.8
    assert sum(found.shares.values()) == pytest.approx(1)


def test_late_commands_and_a_soft_belt_are_one_set_where_a_single_loop_swings(robot):
    found = heard(robot, log(TIGHT, late=4))
    assert {(c.effect, c.location) for c in found.causes} == {
        ("command_delay", "robot"),
        ("transmission_elasticity", "elbow"),
        ("backlash", "elbow"),
    }
    first = found.causes[0]
    assert (first.effect, first.location) == ("command_delay", "robot")
    delay = first.parameters["delay"]
    assert (
        delay.low < 0.004 + 0.0005 - 0.0015 < delay.high
    )  # and half a tick of the controller, less what is usual
    assert sum(c.probability for c in found.causes) < 1 + 1e-9
    assert [c.probability for c in found.causes] == sorted(
        (c.probability for c in found.causes), reverse=True
    )


def test_nothing_swings_on_a_healthy_arm(robot):
    for gains in (CALM, TIGHT):
        assert heard(robot, log(gains)) is None


def test_nothing_is_said_without_gains_or_of_what_rang_before_or_stands_on_its_feet(robot):
    one = log(CALM, spring=400.0)
    signals = condition(one, load_subject(robot, [one]))
    assert unstable([signals]) is not None
    gains = signals.subject.gains.copy()
    gains[0, 0] = np.nan
    assert unstable([replace(signals, subject=replace(signals.subject, gains=gains))]) is None
    assert unstable([replace(signals, subject=replace(signals.subject, base="floating"))]) is None
    assert (
        unstable(
            [replace(signals, limit_cycle=replace(signals.limit_cycle, joints=np.zeros(2, bool)))]
        )
        is None
    )


def test_a_diagnosis_names_what_makes_the_loops_unstable(robot):
    test = log(CALM, spring=400.0)
    found = diagnose(robot, [test], [log(CALM, role="reference")], threads=1)
    assert found.verdict == "ambiguous"
    assert {c.location for c in found.causes} == {"elbow"}
    assert found.causes[0].effect == "transmission_elasticity"
    assert sum(c.probability for c in (*found.causes, *found.rivals)) < 1 + 1e-9
    shapes = [one["shape"] for one in found.residual_shape]
    assert {"ringing", "unstable"}.intersection(shapes)
    assert "chatter" not in shapes


def test_joints_swing_as_the_mode_does(robot):
    test = log(TIGHT, late=4)
    signals = condition(test, load_subject(robot, [test]))
    _, speed, mode = swinging(signals, "command_delay", "robot")
    assert np.sum((speed - mode) ** 2) < 0.1 * np.sum(speed**2)
    assert swinging(signals, "command_delay", "elbow") is None
