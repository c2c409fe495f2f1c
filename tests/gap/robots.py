"""Robots as other people write them, and logs of their simulation in plain MuJoCo, away from the code under test."""

from __future__ import annotations

import mujoco
import numpy as np

from hyperleg_design.gap.log import Log
from hyperleg_design.gap.metadata import Metadata

PENDULUM = """
<mujoco model="pendulum">
  <option timestep="0.0005" integrator="RK4"/>
  <worldbody>
    <body name="arm" pos="0 0 1">
      <joint name="swing" axis="0 1 0" damping="0.02" armature="0.003"/>
      <inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.0006 0.0006 0.0001"/>
    </body>
  </worldbody>
  <actuator><motor name="servo" joint="swing" ctrlrange="-3 3"/></actuator>
</mujoco>
"""

ARM = """
<mujoco model="six_axis">
  <compiler angle="radian" meshdir="nowhere"/>
  <option timestep="0.0005" integrator="RK4"/>
  <asset><mesh name="shell" file="shell.stl"/></asset>
  <default><joint armature="0.1"/></default>
  <worldbody>
    <geom name="table" type="plane" size="2 2 0.1"/>
    <body name="shoulder" pos="0 0 0.163">
      <joint name="shoulder_pan" axis="0 0 1" range="-6.28 6.28" damping="1"/>
      <inertial pos="0 -0.02 -0.002" mass="3.7" diaginertia="0.0102 0.0102 0.0067"/>
      <geom type="mesh" mesh="shell" contype="0" conaffinity="0"/>
      <body name="upper_arm" pos="0 0.138 0" quat="0.7071068 0 0.7071068 0">
        <joint name="shoulder_lift" axis="0 1 0" damping="1"/>
        <inertial pos="0 0 0.2125" mass="8.4" fullinertia="0.13 0.131 0.015 0.001 0.002 -0.001"/>
        <geom type="capsule" size="0.06" fromto="0 0 0 0 0 0.42" contype="0" conaffinity="0"/>
        <body name="forearm" pos="0 -0.131 0.425">
          <joint name="elbow" axis="0 1 0" pos="0 0.01 0" damping="0.5"/>
          <inertial pos="0 0 0.196" mass="2.3" diaginertia="0.031 0.031 0.004"/>
          <body name="wrist_1_link" pos="0 0 0.392" quat="0.7071068 0 0.7071068 0">
            <joint name="wrist_1" axis="0 1 0" damping="0.2"/>
            <inertial pos="0 0.127 0" mass="1.2" diaginertia="0.0026 0.0026 0.0022"/>
            <body name="wrist_2_link" pos="0 0.127 0">
              <joint name="wrist_2" axis="0 0 1" damping="0.2"/>
              <inertial pos="0 0 0.1" mass="1.2" diaginertia="0.0026 0.0026 0.0022"/>
              <body name="wrist_3_link" pos="0 0 0.1">
                <joint name="wrist_3" axis="0 1 0" damping="0.1"/>
                <inertial pos="0 0.077 0" mass="0.19" diaginertia="0.0002 0.0002 0.0001"/>
                <body name="flange" pos="0 0.1 0"/>
              </body>
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="a1" joint="shoulder_pan" kp="2000" kv="200" forcerange="-150 150"/>
    <position name="a2" joint="shoulder_lift" kp="2000" kv="200" forcerange="-150 150"/>
    <position name="a3" joint="elbow" kp="2000" kv="150" forcerange="-150 150"/>
    <position name="a4" joint="wrist_1" kp="500" kv="50" forcerange="-28 28"/>
    <position name="a5" joint="wrist_2" kp="500" kv="50" forcerange="-28 28"/>
    <position name="a6" joint="wrist_3" kp="500" kv="50" forcerange="-28 28"/>
  </actuator>
</mujoco>
"""

COUPLED = """
<mujoco model="rig">
  <option timestep="0.0005" integrator="RK4"/>
  <worldbody>
    <body name="thigh" pos="0 0 1">
      <joint name="hip" axis="0 1 0" damping="0.05"/>
      <inertial pos="0 0 -0.15" mass="1.5" diaginertia="0.02 0.02 0.002"/>
      <body name="shank" pos="0 0 -0.3">
        <joint name="knee" axis="0 1 0" damping="0.03"/>
        <inertial pos="0.01 0 -0.12" mass="0.8" diaginertia="0.008 0.008 0.001"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <fixed name="front" armature="0.002"><joint joint="hip" coef="6"/><joint joint="knee" coef="-4"/></fixed>
    <fixed name="back" armature="0.002"><joint joint="hip" coef="6"/><joint joint="knee" coef="4"/></fixed>
  </tendon>
  <actuator><motor name="m_front" tendon="front" ctrlrange="-4 4"/><motor name="m_back" tendon="back" ctrlrange="-4 4"/></actuator>
</mujoco>
"""


def without_missing_meshes(text: str) -> str:
    """The arm as its simulation can load it."""
    return "\n".join(line for line in text.splitlines() if "mesh=" not in line and "<mesh" not in line).replace(' meshdir="nowhere"', "")


def servo_run(text: str, target, duration: float, rate: float = 200.0, **metadata) -> Log:
    """Log of a robot that follows targets through actuators of its own file.

    Args:
        text: MJCF.
        target: from time to controls `(nu,)`.
        duration: [s].
        rate: of the log [Hz].
        **metadata: of the log.
    """
    model = mujoco.MjModel.from_xml_string(without_missing_meshes(text))
    data = mujoco.MjData(model)
    joints = [model.joint(i).name for i in range(model.njnt)]
    motors = [model.actuator(i).name for i in range(model.nu)]
    every = round(1 / (rate * model.opt.timestep))
    rows = []
    for step in range(round(duration / model.opt.timestep)):
        if step % every == 0:
            data.ctrl[:] = target(data.time)
            mujoco.mj_forward(model, data)
            rows.append(np.concatenate([[data.time], data.qpos, data.qvel, data.ctrl, data.actuator_force]))
        data.ctrl[:] = target(data.time + model.opt.timestep / 2)  # held for a step, so that of its middle
        mujoco.mj_step(model, data)
    table = np.array(rows)
    n, m = len(joints), len(motors)
    position, velocity, control, force = np.split(table[:, 1:], [n, 2 * n, 2 * n + m], 1)
    signals = {f"position/{j}": position[:, i] for i, j in enumerate(joints)} | {f"velocity/{j}": velocity[:, i] for i, j in enumerate(joints)}
    signals |= {f"motor_torque/{a}": force[:, i] for i, a in enumerate(motors)}
    if m == n and (model.actuator_biastype != 0).all():
        signals |= {f"position_target/{j}": control[:, i] for i, j in enumerate(joints)}
    return Log("run", table[:, 0], signals, Metadata(**metadata))


def waves(count: int, amplitude, slow: float = 0.2, fast: float = 1.5, seed: int = 0):
    """Sums of three sines for each of some channels, starting smoothly from zero."""
    rng = np.random.default_rng(seed)
    frequency, phase = rng.uniform(slow, fast, (3, count)), rng.uniform(0, 2 * np.pi, (3, count))

    def at(time: float) -> np.ndarray:
        ramp = 1 - np.exp(-((time / 0.5) ** 2))
        return ramp * np.asarray(amplitude) / 3 * np.sin(2 * np.pi * frequency * time + phase).sum(0)

    return at


def quantised(log: Log, size: float) -> Log:
    """Positions rounded to a grid, velocities taken out."""
    signals = {c: np.round(v / size) * size if c.startswith("position/") else v for c, v in log.signals.items() if not c.startswith("velocity/")}
    return log.changed(signals=signals)
