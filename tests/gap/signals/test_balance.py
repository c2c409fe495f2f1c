"""Balance of a leg on a rail that hops on a floor whose forces nobody measures, in a plain MuJoCo
loop.
"""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject

HEIGHT, JOINTS = 0.42, ("rail", "hip", "knee")
LEG = """
<mujoco><option timestep="0.0005"/><default><geom contype="0" conaffinity="0"/></default>
<worldbody>
  <geom name="floor" type="plane" size="2 2 .1" pos="0 0 {floor}" contype="1" conaffinity="1"/>
  <body name="carriage" pos="0 0 0.42">
    <joint name="rail" type="slide" axis="0 0 1"/><geom type="box" size=".08 .06 .03" mass="2"/>
    <body name="thigh">
      <joint name="hip" axis="0 1 0" armature="0.01"/>
      <geom type="capsule" fromto="0 0 0 0 0 -.2" size=".02" mass="0.8"/>
      <body name="shank" pos="0 0 -0.2">
        <joint name="knee" axis="0 1 0" armature="0.01"/>
        <geom type="capsule" fromto="0 0 0 0 0 -.2" size=".015" mass=".3"/>
        <geom name="foot" type="sphere" size=".02" pos="0 0 -.2" contype="1" conaffinity="1"
          mass=".1"/>
</body></body></body></worldbody>
<actuator><motor name="m_hip" joint="hip"/><motor name="m_knee" joint="knee"/></actuator></mujoco>
"""


def write(path, floor=0.0):
    path.write_text(LEG.format(floor=floor))
    return path


def hops(robot, seconds=6.0):
    """Log at 500 Hz of squats that end in the air."""
    model = mujoco.MjModel.from_xml_path(str(robot))
    data, rows = mujoco.MjData(model), []
    data.qpos[:] = [0.0, 0.5, -1.0]
    data.qpos[0] = 0.02 + 0.4 * np.cos(0.5) - HEIGHT
    for tick in range(int(seconds / model.opt.timestep)):
        bend = 0.6 + 0.45 * np.sin(2 * np.pi * 2.5 * data.time)
        target = np.array([bend, -2 * bend])
        torque = 200 * (target - data.qpos[1:]) - 4 * data.qvel[1:]
        data.ctrl = torque
        if tick % 4 == 0:
            touches = any({"floor", "foot"} == _names(model, c) for c in data.contact)
            rows.append([data.time, *data.qpos, *data.qvel, *torque, touches])
        mujoco.mj_step(model, data)
    rows = np.array(rows)
    columns = [f"{kind}/{joint}" for kind in ("position", "velocity") for joint in JOINTS]
    columns += [f"motor_torque/{motor}" for motor in ("m_hip", "m_knee")]
    signals = dict(zip(columns, rows[:, 1:-1].T, strict=True))
    return Log("hops", rows[:, 0], signals, Metadata(base="fixed")), rows[:, -1] > 0


def _names(model, contact):
    return {model.geom(contact.geom1).name, model.geom(contact.geom2).name}


@pytest.fixture(scope="module")
def hopping(tmp_path_factory):
    robot = write(tmp_path_factory.mktemp("rail") / "leg.xml")
    log, touches = hops(robot)
    return robot, log, touches


def test_where_a_foot_may_touch_is_seen_from_the_floor(hopping):
    robot, log, touches = hopping
    assert 0.1 < touches.mean() < 0.9
    signals = condition(log, load_subject(robot, [log]))
    assert signals.touching[touches[: len(signals.touching)], 0].all()
    assert not signals.touching.all()


def test_forces_of_the_floor_are_in_no_row(hopping, tmp_path):
    robot, log, touches = hopping
    unaware = write(tmp_path / "no_floor.xml", floor=-5.0)
    free, blind = (condition(log, load_subject(f, [log])) for f in (robot, unaware))
    assert blind.touching is None
    judged = np.sqrt(np.nanmean(free.residual["motion"] ** 2, axis=0))
    beside = np.sqrt(np.nanmean(blind.residual["motion"] ** 2, axis=0))
    assert (judged < 0.15 * beside).all()
    in_stance = np.isfinite(free.residual["motion"])[touches[: len(free.time)]]
    assert in_stance.mean(0).max() > 0.5


def test_a_floor_that_the_foot_is_far_below_lies_elsewhere(hopping, tmp_path):
    _, log, _ = hopping
    above = write(tmp_path / "above.xml", floor=0.3)
    assert condition(log, load_subject(above, [log])).touching is None
