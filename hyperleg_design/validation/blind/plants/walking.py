"""Plant for a robot on its feet: MuJoCo's contact with another step, integrator, cone and contact
law than the simulator's, drives of two masses.

The body is MuJoCo's without friction and rotors; those, belts and drives are integrated here at
0.25 ms and act as applied joint torques, as in `rig`. Targets come from `Stand`: squats,
sways, twists and rocking on both feet, with the ankle strategy of a residual controller that sees
the body's tilt. No walking policy drives it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.mjcf import FLOOR, mujoco_spec
from hyperleg_design.validation.blind.plants.plant import RigPlant
from hyperleg_design.validation.blind.plants.rig import BRISTLE_DAMPING
from hyperleg_design.validation.blind.plants.stand import AHEAD, Stand
from hyperleg_design.validation.blind.robots.chain import Chain

STEP = 0.25e-3
"""Of the integrator [s]."""
CONTROL_STEPS = 4
"""Integrator steps a tick of the drives' controllers: 1 kHz."""
SETTLING = 1.0
"""Time of standing before the recording begins [s]."""
FALLEN = 0.45
"""Height of the pelvis below which a run is given up [m]."""


@dataclass(frozen=True, eq=False)
class Ground:
    """What the feet stand on; the drawn values of a plant."""

    friction: float
    """Sliding, over the nominal [-]."""
    stiffness: float
    """Of a pad's contact, per unit of effective mass [1/s^2]."""
    damping: float
    """[1/s]"""


@dataclass(frozen=True, eq=False)
class WalkingPlant:
    """A robot with its ground and its sensors."""

    model: Any
    """Compiled MuJoCo model without rotors and joint friction."""
    drives: RigPlant
    """Of the `n` joints; its rigid-body model is not used."""
    gyro_bias: np.ndarray
    accelerometer_bias: np.ndarray
    """`(3,)` [rad/s], [m/s^2]."""
    push: np.ndarray
    """Horizontal force of a periodic push on the pelvis `(3,)` [N]."""


@dataclass(frozen=True, eq=False)
class WalkingTrace:
    """What truly happened at the drives' ticks, `k` of them, and the targets that the host sent,
    `t` ticks.
    """

    time: np.ndarray
    targets: np.ndarray
    """`(t, n)` [rad]"""
    encoder: np.ndarray
    speed: np.ndarray
    """`(k, n)` [rad], [rad/s]"""
    motor_velocity: np.ndarray
    command: np.ndarray
    drive_torque: np.ndarray
    temperature: np.ndarray
    """`(k, m)`"""
    voltage: np.ndarray
    """`(k,)` [V]"""
    base: np.ndarray
    """Position, quaternion w first, velocity in the world `(k, 10)`."""
    gyro: np.ndarray
    accelerometer: np.ndarray
    """Base frame, biases included `(k, 3)`."""
    contact: np.ndarray
    """Force of the ground on each pad, in the world `(k, pads, 3)` [N]."""
    fell: bool


def walking_model(
    chain: Chain, masses: Chain, ground: Ground, pelvis: float, gravity: np.ndarray
) -> Any:
    """The robot on its ground in MuJoCo; `masses` has the true links, `pelvis` the factor on the
    pelvis' mass.

    Args:
        chain: the nominal robot.
        masses: the robot with its true links.
        ground: under it.
        pelvis: factor on the pelvis' mass.
        gravity: `(3,)` [m/s^2].

    Returns:
        The compiled model.
    """
    import mujoco

    spec = mujoco_spec(load_design(chain.name), friction=False)
    spec.option.timestep = STEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 5.0
    spec.option.gravity = gravity
    for tendon in spec.tendons:
        tendon.armature = 0.0
    for geom in spec.geoms:
        if geom.conaffinity or geom.name == FLOOR:
            geom.solref = [-ground.stiffness, -ground.damping]
            geom.solimp = [0.85, 0.98, 0.003, 0.4, 2.0]
            geom.friction = [geom.friction[0] * ground.friction, geom.friction[1], geom.friction[2]]
            geom.condim = 4
    model = spec.compile()
    for link in masses.links:
        body = model.body(link.name).id
        values, axes = np.linalg.eigh(link.inertia)
        if np.linalg.det(axes) < 0:
            axes[:, 0] *= -1
        model.body_mass[body] = link.mass
        model.body_ipos[body] = link.com
        model.body_inertia[body] = values
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, axes.ravel())
        model.body_iquat[body] = quaternion
    root = model.body("pelvis").id
    model.body_mass[root] *= pelvis
    model.body_inertia[root] *= pelvis
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


def pad_names(model: Any) -> tuple[str, ...]:
    """Contact shapes of the soles.

    Args:
        model: the compiled model.

    Returns:
        Their names.
    """
    return tuple(model.geom(i).name for i in range(model.ngeom) if model.geom_conaffinity[i] == 1)


def simulate_walking(
    plant: WalkingPlant, chain: Chain, stand: Stand, duration: float, rate: float, seed: int
) -> WalkingTrace:
    """Run one robot.

    Args:
        plant: the robot.
        chain: nominal robot, for the controllers' posture.
        stand: what it does.
        duration: of the recording [s].
        rate: of the host [Hz]; divides 1 kHz.
        seed: of lost commands.
    """
    import mujoco

    model, p = plant.model, plant.drives
    data = mujoco.MjData(model)
    n, m = p.joint_from_motor.shape
    address = np.array([model.joint(j).qposadr[0] for j in chain.joints])
    dof = np.array([model.joint(j).dofadr[0] for j in chain.joints])
    assert np.array_equal(address, np.arange(7, 7 + n))
    assert np.array_equal(dof, np.arange(6, 6 + n))
    sides = _sides(model, chain)
    control, h = STEP * CONTROL_STEPS, STEP
    hold, lead = round(1.0 / (rate * control)), round(SETTLING / control)
    ticks = round(duration * rate)
    count = ticks * hold
    matrix, allot = p.joint_from_motor, np.linalg.pinv(p.declared)
    inverse_rotor = 1.0 / p.rotor_inertia
    friction = {
        k: getattr(p, k)[m:] for k in ("coulomb", "static", "stribeck_speed", "viscous", "bristle")
    }
    size = np.maximum(friction["static"], 1e-9)
    lag, late = -np.expm1(-h / np.maximum(p.lag, 1e-6)), p.delay / control
    whole = np.floor(late).astype(int)
    part = late - whole
    dice = np.random.default_rng(seed)
    silent = 0

    first = stand.targets(0.0, AHEAD, 0.0, 0.0, 0.0, sides)
    data.qpos[7:] = first
    mujoco.mj_kinematics(model, data)
    pads = [model.geom(name).id for name in pad_names(model)]
    data.qpos[2] -= min(data.geom_xpos[g, 2] - model.geom_size[g, 0] for g in pads)
    mujoco.mj_forward(model, data)
    rotor, spin = matrix.T @ data.qpos[7:], np.zeros(m)
    bristles, speed, current = np.zeros(n), np.zeros(n), np.zeros(m)
    history = np.zeros((128, m))
    columns = np.arange(m)
    smooth = -np.expm1(-2 * np.pi * p.velocity_bandwidth * control)
    pad_of = {g: i for i, g in enumerate(pads)}
    previous = fresh_target = first
    ankles = [model.body(f"{side}_foot").id for side in ("left", "right")]
    recorded = {
        k: np.zeros((count, w))
        for k, w in (
            ("encoder", n),
            ("speed", n),
            ("motor_velocity", m),
            ("command", m),
            ("drive_torque", m),
            ("temperature", m),
            ("base", 10),
            ("gyro", 3),
            ("accelerometer", 3),
        )
    }
    contact, targets = np.zeros((count, len(pads), 3)), np.zeros((ticks, n))
    gyro = model.sensor("gyro").adr[0]
    accelerometer = model.sensor("accelerometer").adr[0]
    wrench, fell = np.zeros(6), False
    root = model.body("pelvis").id
    for tick in range(-lead, count):
        row, within = divmod(tick, hold)
        if within == 0:
            ahead = data.subtree_com[root, 0] - 0.5 * (
                data.xpos[ankles[0], 0] + data.xpos[ankles[1], 0]
            )
            mujoco.mj_subtreeVel(model, data)
            previous = fresh_target
            fresh_target = stand.targets(
                row / rate,
                ahead,
                data.subtree_linvel[root, 0],
                _roll(data.qpos[3:7]),
                data.qvel[3],
                sides,
            )
            if tick >= 0:
                targets[row] = previous
        # The drives run from one target to the next, which smooths the steps between the host's
        # ticks.
        target = previous + (fresh_target - previous) * (within / hold)
        encoder = data.qpos[7:] + p.offset + p.drift * max(tick * control, 0.0)
        encoder = np.round(encoder / p.resolution) * p.resolution
        speed = speed + smooth * (data.qvel[6:] - speed)
        fresh = allot @ (p.stiffness * (target - encoder) - p.damping * speed)
        if p.loss and silent == 0 and dice.random() < p.loss * control / (0.04 * (1 - p.loss)):
            silent = 1 + int(dice.exponential(0.04) / control)
        history[tick % 128] = history[(tick - 1) % 128] if silent else fresh
        silent = max(silent - 1, 0)
        index = (tick - whole) % 128
        wanted = np.clip(
            (1 - part) * history[index, columns] + part * history[index - 1, columns],
            -p.peak_torque,
            p.peak_torque,
        )
        thrust = max(np.sin(2 * np.pi * p.push_frequency * tick * control), 0.0) ** 6
        data.xfrc_applied[root, :3] = plant.push * thrust
        if tick >= 0:
            recorded["encoder"][tick] = encoder
            recorded["speed"][tick] = speed
            recorded["motor_velocity"][tick] = spin
            recorded["command"][tick] = fresh
            recorded["drive_torque"][tick] = current
            recorded["temperature"][tick] = p.start_temperature
            recorded["base"][tick, :7], recorded["base"][tick, 7:] = data.qpos[:7], data.qvel[:3]
            recorded["gyro"][tick] = data.sensordata[gyro : gyro + 3] + plant.gyro_bias
            recorded["accelerometer"][tick] = (
                data.sensordata[accelerometer : accelerometer + 3] + plant.accelerometer_bias
            )
            for number in range(data.ncon):
                touch = data.contact[number]
                pad = pad_of.get(touch.geom2, pad_of.get(touch.geom1))
                if pad is not None:
                    mujoco.mj_contactForce(model, data, number, wrench)
                    force = touch.frame.reshape(3, 3).T @ wrench[:3]
                    contact[tick, pad] += force if touch.geom2 in pad_of else -force
        for _ in range(CONTROL_STEPS):
            current = current + lag * (wanted - current)
            q, qd = data.qpos[7:], data.qvel[6:]
            taut = rotor - q @ matrix
            pull = p.belt_stiffness * taut + p.belt_damping * (spin - qd @ matrix)
            capacity = (
                friction["coulomb"]
                + (friction["static"] - friction["coulomb"])
                * np.exp(-((qd / friction["stribeck_speed"]) ** 2))
                + 1e-12
            )
            new = (bristles + h * qd / friction["bristle"]) / (
                1 + h * np.abs(qd) * size / (friction["bristle"] * capacity)
            )
            held = size * (new + BRISTLE_DAMPING / h * (new - bristles)) + friction["viscous"] * qd
            bristles = new
            data.qfrc_applied[6:] = matrix @ pull - held - p.spring * (q - p.spring_rest)
            spin = spin + h * inverse_rotor * (p.torque_scale * current - pull)
            rotor = rotor + h * spin
            mujoco.mj_step(model, data)
        if data.qpos[2] < FALLEN or not np.isfinite(data.qpos[2]):
            fell = True
            break
    time = np.arange(count) * control
    return WalkingTrace(
        time=time,
        targets=targets,
        contact=contact,
        voltage=np.full(count, p.voltage),
        fell=fell,
        **recorded,
    )


def _roll(quaternion: np.ndarray) -> float:
    """Roll of a body [rad], right side down positive."""
    w, x, y, z = quaternion
    return float(np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)))


def _sides(model: Any, chain: Chain) -> np.ndarray:
    """Signs of hip yaw (both feet turn the same way), hip roll and ankle roll (both legs lean the
    same way) `(2, 3)`.
    """
    half = len(chain.joints) // 2
    rows = []
    for leg in range(2):
        axes = [model.jnt_axis[model.joint(chain.joints[leg * half + k]).id] for k in (0, 1, 5)]
        rows.append([np.sign(axes[0][2]), np.sign(axes[1][0]), np.sign(axes[2][0])])
    return np.array(rows)
