"""Robots as other people write them, and logs of their simulation in plain MuJoCo, away from the
code under test.
"""

from __future__ import annotations

from functools import cache

import mujoco
import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata

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
"""  # noqa: E501

SERVOS = """
<mujoco model="servos">
  <option timestep="0.0005"/>
  <worldbody>
    <body name="thigh" pos="0 0 1">
      <joint name="hip" axis="0 1 0" damping="0.5" frictionloss="0.5" armature="0.05"/>
      <inertial pos="0 0 -0.15" mass="3" diaginertia="0.03 0.03 0.003"/>
      <body name="shank" pos="0 0 -0.35">
        <joint name="knee" axis="0 1 0" damping="0.4" frictionloss="0.4" armature="0.04"/>
        <inertial pos="0 0 -0.15" mass="2" diaginertia="0.02 0.02 0.002"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="s_hip" joint="hip" kp="200" kv="8" forcerange="-80 80"/>
    <position name="s_knee" joint="knee" kp="120" kv="5" forcerange="-60 60"/>
  </actuator>
</mujoco>
"""


def without_missing_meshes(text: str) -> str:
    """The arm as its simulation can load it."""
    return "\n".join(
        line for line in text.splitlines() if "mesh=" not in line and "<mesh" not in line
    ).replace(' meshdir="nowhere"', "")


ONE_SERVO = """
<mujoco model="servo">
  <option timestep="0.001" integrator="implicitfast"/>
  <worldbody>
    <body name="lever">
      <joint name="swing" axis="0 1 0" armature="0.01" damping="0.4"/>
      <inertial pos="0.1 0 0" mass="0.3" diaginertia="1e-3 1e-3 1e-3"/>
    </body>
  </worldbody>
  <actuator><position name="s" joint="swing" kp="8" kv="0" forcerange="-3 3"/></actuator>
</mujoco>
"""


def servo_run(text: str, target, duration: float, rate: float = 200.0, **metadata) -> Log:
    """Log of a robot that follows targets through actuators of its own file.

    Args:
        text: MJCF.
        target: from times `(t,)` to controls `(t, nu)`.
        duration: [s].
        rate: of the log [Hz].
        **metadata: of the log.
    """
    model = mujoco.MjModel.from_xml_string(without_missing_meshes(text))
    data = mujoco.MjData(model)
    joints = [model.joint(i).name for i in range(model.njnt)]
    motors = [model.actuator(i).name for i in range(model.nu)]
    every, step = round(1 / (rate * model.opt.timestep)), model.opt.timestep
    time = np.arange(round(duration / step)) * step
    asked, held = target(time[::every]), target(time + step / 2)  # held for a step: of its middle
    rows = []
    for first, now, control in zip(range(0, len(time), every), time[::every], asked, strict=True):
        data.ctrl[:] = control
        mujoco.mj_forward(model, data)
        rows.append(np.concatenate([[now], data.qpos, data.qvel, control, data.actuator_force]))
        for control in held[first : first + every]:
            data.ctrl[:] = control
            mujoco.mj_step(model, data)
    table = np.array(rows)
    n, m = len(joints), len(motors)
    position, velocity, control, force = np.split(table[:, 1:], [n, 2 * n, 2 * n + m], 1)
    signals = {f"position/{j}": position[:, i] for i, j in enumerate(joints)} | {
        f"velocity/{j}": velocity[:, i] for i, j in enumerate(joints)
    }
    signals |= {f"motor_torque/{a}": force[:, i] for i, a in enumerate(motors)}
    if m == n and (model.actuator_biastype != 0).all():
        signals |= {f"position_target/{j}": control[:, i] for i, j in enumerate(joints)}
    return Log("run", table[:, 0], signals, Metadata(**metadata))


def with_torque_sensors(log: Log) -> Log:
    """Log of `COUPLED` with torque sensors between gears and links, and with commands in place of
    measured motor torques.
    """
    matrix, rotor, damping = np.array([[6.0, 6.0], [-4.0, 4.0]]), 0.002, np.array([0.05, 0.03])
    given = log.stack("motor_torque", ("m_front", "m_back"))
    velocity = log.stack("velocity", ("hip", "knee"))
    acceleration = np.gradient(velocity, log.time, axis=0)
    held = (given - rotor * acceleration @ matrix) @ matrix.T - damping * velocity
    signals = {k: v for k, v in log.signals.items() if not k.startswith("motor_torque")}
    signals |= {"joint_torque/hip": held[:, 0], "joint_torque/knee": held[:, 1]}
    signals |= {
        "motor_torque_command/m_front": given[:, 0],
        "motor_torque_command/m_back": given[:, 1],
    }
    metadata = log.metadata.changed(torque_sensors=("hip", "knee"))
    return log.changed(signals=signals, metadata=metadata)


def waves(count: int, amplitude, slow: float = 0.2, fast: float = 1.5, seed: int = 0):
    """Sums of three sines for each of some channels, starting smoothly from zero."""
    rng = np.random.default_rng(seed)
    frequency, phase = rng.uniform(slow, fast, (3, count)), rng.uniform(0, 2 * np.pi, (3, count))

    def at(time) -> np.ndarray:
        """Of times of any shape, with the channels as another axis."""
        time = np.asarray(time)[..., None]
        angle = 2 * np.pi * frequency * time[..., None] + phase
        ramp = 1 - np.exp(-((time / 0.5) ** 2))
        return ramp * np.asarray(amplitude) / 3 * np.sin(angle).sum(-2)

    return at


def quantised(log: Log, size: float) -> Log:
    """Positions rounded to a grid, velocities taken out."""
    signals = {
        c: np.round(v / size) * size if c.startswith("position/") else v
        for c, v in log.signals.items()
        if not c.startswith("velocity/")
    }
    return log.changed(signals=signals)


def noisy(log: Log, seed: int, torque: float = 0.02) -> Log:
    """Rounded positions without velocities, and white noise in torques [Nm]."""
    rng = np.random.default_rng(seed)
    rounded = quantised(log, 5e-4)
    return rounded.changed(
        signals={
            c: v + rng.normal(0, torque, len(v)) if c.startswith("motor_torque/") else v
            for c, v in rounded.signals.items()
        }
    )


def biped_run(height: float = 0.0, duration: float = 0.7, **metadata) -> Log:
    """Our biped bending its knees, standing or thrown up, in plain MuJoCo at half a millisecond;
    all a log can hold.

    Args:
        height: of the soles over the floor at the start [m]; above 0 it also turns.
        duration: [s]; standing, it topples after a second.
        **metadata: of the log.
    """
    import copy

    from hyperleg_design.gap.signals.loading import load_subject
    from hyperleg_design.simulation.drives.actuation import friction_damping

    subject = load_subject("hyperleg")
    model = copy.copy(subject.model)
    model.opt.timestep, model.opt.integrator = 0.0005, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    data = mujoco.MjData(model)
    data.qpos[7:] = subject.default
    mujoco.mj_kinematics(model, data)
    data.qpos[2] += (
        height - 0.0005 - min(data.geom(p.name).xpos[2] - p.radius for p in subject.pads)
    )
    data.qvel[3:6] = [0.5, -0.3, 0.2] if height else 0.0
    stiffness, damping = subject.gains.T
    pads = [p.name for p in subject.pads]
    rows = []
    for step in range(round(duration / model.opt.timestep)):
        bend = np.array([0, 0, -1, 2, -1, 0, 0] * 2) * 0.08 * np.sin(2 * np.pi * 0.8 * data.time)
        torque = stiffness * (subject.default + bend - data.qpos[7:]) - damping * data.qvel[6:]
        data.qfrc_applied[6:] = torque
        model.dof_damping[6:] = friction_damping(
            subject.coulomb, subject.viscous, data.qvel[6:], subject.friction_speed
        )
        if step % 10 == 0:
            mujoco.mj_forward(model, data)
            felt = data.xmat[1].reshape(3, 3).T @ (data.qacc[:3] - model.opt.gravity)
            pushed = np.zeros((len(pads), 3))
            for number in range(data.ncon):
                contact, wrench = data.contact[number], np.zeros(6)
                mujoco.mj_contactForce(model, data, number, wrench)
                force = contact.frame.reshape(3, 3).T @ wrench[:3]
                first, second = (model.geom(g).name for g in (contact.geom1, contact.geom2))
                pushed[pads.index(second if second in pads else first)] += (
                    force if second in pads else -force
                )
            state = [
                [data.time],
                data.qpos,
                data.qvel,
                torque,
                subject.default + bend,
                felt,
                pushed.ravel(),
            ]
            rows.append(np.concatenate(state))
        mujoco.mj_step(model, data)
    time, place, turn, q, v, spin, _, torque, target, felt, force = np.split(
        np.array(rows), np.cumsum([1, 3, 4, 14, 3, 3, 14, 14, 14, 3]), 1
    )
    columns = [(f"position/{j}", q[:, i]) for i, j in enumerate(subject.joints)] + [
        (f"joint_torque/{j}", torque[:, i]) for i, j in enumerate(subject.joints)
    ]
    columns += [(f"position_target/{j}", target[:, i]) for i, j in enumerate(subject.joints)]
    for kind, values in (
        ("base_position", place),
        ("base_velocity", v),
        ("gyro", spin),
        ("accelerometer", felt),
    ):
        columns += [(f"{kind}/{axis}", values[:, i]) for i, axis in enumerate("xyz")]
    columns += [(f"base_orientation/{axis}", turn[:, i]) for i, axis in enumerate("wxyz")]
    columns += [
        (f"contact_force/{p}_{axis}", force[:, 3 * k + i])
        for k, p in enumerate(pads)
        for i, axis in enumerate("xyz")
    ]
    return Log(
        "biped",
        time[:, 0],
        dict(columns),
        Metadata(**{"robot": "hyperleg", "base": "floating", **metadata}),
    )


def without(log: Log, *kinds: str) -> Log:
    """A log that lacks some signals."""
    return log.changed(
        signals={c: v for c, v in log.signals.items() if c.partition("/")[0] not in kinds}
    )


GEARS = np.array([9.0, -6.0])
GAINS = np.array([[80.0, 3.0], [30.0, 1.0]])
GEARED = """
<mujoco model="geared"><compiler angle="radian"/><option timestep="0.001" integrator="implicitfast"/><worldbody>
<body name="thigh" pos="0 0 1"><joint name="hip" axis="0 1 0" damping="0.3" frictionloss="0.3" armature="0.05"/>
<inertial pos="0 0 -0.15" mass="3" diaginertia="0.03 0.03 0.004"/>
<body name="shank" pos="0 0 -0.35"><joint name="knee" axis="0 1 0" damping="0.2" frictionloss="0.2" armature="0.02"/>
<inertial pos="0 0 -0.15" mass="1.5" diaginertia="0.015 0.015 0.002"/></body></body></worldbody>
<actuator><motor name="a" joint="hip" gear="9" ctrlrange="-12 12"/><motor name="b" joint="knee" gear="-6" ctrlrange="-8 8"/></actuator></mujoco>"""  # noqa: E501


def geared_run(side, names, *, weak=1.0, load=0.0, constant=None, seed=0, **metadata):
    """A log of `GEARED`, torques and speeds of the motors as of one side of their gears; a weak
    hip, a load on the shank [kg].
    """
    table, noise = _geared_motion(weak, load, seed)
    gear = GEARS if side == "motor" else np.ones(2)
    signals = {}
    for i, joint in enumerate(("hip", "knee")):
        signals |= {
            f"position_target/{joint}": table[:, 1 + i],
            f"position/{joint}": table[:, 3 + i],
            f"velocity/{joint}": table[:, 5 + i],
        }
        torque = table[:, 7 + i] / gear[i]
        signals |= {
            f"motor_torque_command/{names[i]}": torque,
            f"motor_velocity/{names[i]}": table[:, 5 + i] * gear[i],
        }
        told = torque + 5e-3 * noise[i]
        signals |= (
            {f"motor_torque/{names[i]}": told}
            if constant is None
            else {f"motor_current/{names[i]}": told / constant}
        )
    gains = dict(zip(("hip", "knee"), map(tuple, GAINS), strict=True))
    constants = {} if constant is None else dict.fromkeys(names, constant)
    return Log(
        f"geared_{seed}",
        table[:, 0],
        signals,
        Metadata(gains=gains, torque_constant=constants, **metadata),
    )


@cache
def _geared_motion(weak: float, load: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Time, targets, positions, velocities and torques of the joints of `GEARED`, and white noise
    of both torques.
    """
    model = mujoco.MjModel.from_xml_string(GEARED)
    model.body_mass[model.body("shank").id] += load  # at its centre of mass
    data, rng = mujoco.MjData(model), np.random.default_rng(seed)
    phase, rows = rng.uniform(0, 6, (3, 2)), []
    times = np.arange(10000) * 0.001
    swing = np.sin(2 * np.pi * np.array([[0.17], [0.6], [1.3]]) * times[:, None, None] + phase)
    targets = (swing * [[0.5], [0.3], [0.1]]).sum(1) * np.minimum(times, 1.0)[:, None]
    for first in range(0, len(times), 5):
        target = targets[first]
        asked = GAINS[:, 0] * (target - data.qpos) - GAINS[:, 1] * data.qvel
        rows.append(np.r_[times[first], target, data.qpos, data.qvel, asked])
        data.ctrl[:] = asked / GEARS * [weak, 1.0]
        mujoco.mj_step(model, data, nstep=5)
    table = np.array(rows)
    table[:, 3:5] += 2e-5 * rng.normal(size=(len(table), 2))
    return table, rng.normal(size=(2, len(table)))
