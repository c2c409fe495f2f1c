"""Robots with gears in their file: logs of motors on either side mean the same robot, and a healthy one has no gap."""

import mujoco
import numpy as np
import pytest

from hyperleg_design.gap.conditioning import condition
from hyperleg_design.gap.diagnose import diagnose
from hyperleg_design.gap.log import Log
from hyperleg_design.gap.metadata import Metadata
from hyperleg_design.gap.subject import load_subject

GEARS = np.array([9.0, -6.0])
GAINS = np.array([[80.0, 3.0], [30.0, 1.0]])
LEG = """
<mujoco model="geared"><compiler angle="radian"/><option timestep="0.001" integrator="implicitfast"/><worldbody>
<body name="thigh" pos="0 0 1"><joint name="hip" axis="0 1 0" damping="0.3" frictionloss="0.3" armature="0.05"/>
<inertial pos="0 0 -0.15" mass="3" diaginertia="0.03 0.03 0.004"/>
<body name="shank" pos="0 0 -0.35"><joint name="knee" axis="0 1 0" damping="0.2" frictionloss="0.2" armature="0.02"/>
<inertial pos="0 0 -0.15" mass="1.5" diaginertia="0.015 0.015 0.002"/></body></body></worldbody>
<actuator><motor name="a" joint="hip" gear="9" ctrlrange="-12 12"/><motor name="b" joint="knee" gear="-6" ctrlrange="-8 8"/></actuator></mujoco>"""


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "geared.xml"
    path.write_text(LEG)
    return path


def swung(side, names, *, weak=1.0, constant=None, seed=0):
    """A log of plain MuJoCo, torques and speeds of the motors as of one side of their gears."""
    model = mujoco.MjModel.from_xml_string(LEG)
    data, rng = mujoco.MjData(model), np.random.default_rng(seed)
    phase, rows = rng.uniform(0, 6, (3, 2)), []
    for step in range(10000):
        time = step * 0.001
        waves = np.sin(2 * np.pi * np.array([[0.17], [0.6], [1.3]]) * time + phase) * np.array([[0.5], [0.3], [0.1]])
        target = waves.sum(0) * min(time, 1.0)
        if step % 5 == 0:
            asked = GAINS[:, 0] * (target - data.qpos) - GAINS[:, 1] * data.qvel
            rows.append(np.r_[time, target, data.qpos, data.qvel, asked])
        data.ctrl[:] = asked / GEARS * np.array([weak, 1.0])
        mujoco.mj_step(model, data)
    table = np.array(rows)
    table[:, 3:5] += 2e-5 * rng.normal(size=(len(table), 2))
    gear = GEARS if side == "motor" else np.ones(2)
    signals = {}
    for i, joint in enumerate(("hip", "knee")):
        signals |= {f"position_target/{joint}": table[:, 1 + i], f"position/{joint}": table[:, 3 + i], f"velocity/{joint}": table[:, 5 + i]}
        torque = table[:, 7 + i] / gear[i]
        signals |= {f"motor_torque_command/{names[i]}": torque, f"motor_velocity/{names[i]}": table[:, 5 + i] * gear[i]}
        told = torque + 5e-3 * rng.normal(size=len(torque))
        signals |= {f"motor_torque/{names[i]}": told} if constant is None else {f"motor_current/{names[i]}": told / constant}
    gains = dict(zip(("hip", "knee"), map(tuple, GAINS), strict=True))
    constants = {} if constant is None else dict.fromkeys(names, constant)
    return Log(f"swing_{seed}", table[:, 0], signals, Metadata(gains=gains, torque_constant=constants))


@pytest.mark.parametrize("side", ["motor", "joint"])
@pytest.mark.parametrize("names", [("a", "b"), ("hip", "knee")])
@pytest.mark.parametrize("constant", [None, 0.1])
def test_a_log_tells_on_which_side_of_the_gear_it_is(robot, side, names, constant):
    log = swung(side, names, constant=constant)
    subject = load_subject(robot, [log])
    assert bool(subject.motor_scale) == (side == "motor")
    assert any("before the gears" in note for note in subject.notes) == (side == "motor")
    signals = condition(log, subject)
    joints = signals.believed
    wanted = GAINS[:, 0] * (signals.target - signals.position) - GAINS[:, 1] * signals.velocity
    assert np.abs(joints - wanted)[100:-100].max() < 0.3
    for balance, most in {"motion": 0.15, "control": 0.02, "transmission": 0.01}.items():
        found = signals.residual[balance][100:-100]
        assert np.sqrt(np.nanmean(found**2)) < most, balance


def test_an_idle_log_goes_by_the_names(robot):
    still = swung("motor", ("a", "b"))
    silent = {c: np.zeros_like(v) if c.startswith("motor") else v for c, v in still.signals.items()}
    assert load_subject(robot, [Log("still", still.time, silent, still.metadata)]).motor_scale
    named = {c.replace("/a", "/hip").replace("/b", "/knee"): v for c, v in silent.items()}
    assert not load_subject(robot, [Log("still", still.time, named, still.metadata)]).motor_scale


def test_a_weak_geared_motor_is_named_with_its_size(robot):
    logs = [swung("motor", ("a", "b"), weak=0.75, seed=seed) for seed in (1, 2)]
    found = diagnose(robot, logs, [swung("motor", ("a", "b"), seed=3)], threads=1)
    assert found.causes[0].effect in {"torque_constant", "transmission_ratio"}
    assert found.causes[0].location == "hip"
    assert found.causes[0].parameters["scale"].value == pytest.approx(0.75, abs=0.02)
