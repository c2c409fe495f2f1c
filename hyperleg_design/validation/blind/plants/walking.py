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
from hyperleg_design.validation.blind.plants.parts import DelayLine
from hyperleg_design.validation.blind.plants.plant import RigPlant
from hyperleg_design.validation.blind.plants.rig import BRISTLE_DAMPING
from hyperleg_design.validation.blind.plants.stand import AHEAD, Stand
from hyperleg_design.validation.blind.robots.chain import Chain

STEP = 0.25e-3
"""Of the integrator [s]."""
CONTROL_STEPS = 4
"""Integrator steps a tick of the drives' controllers: 1 kHz."""
CONTROL = STEP * CONTROL_STEPS
"""Between ticks of the controllers [s]."""
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

    Returns:
        What happened; of a robot that fell up to there, zeros behind.
    """
    hold, lead = round(1.0 / (rate * CONTROL)), round(SETTLING / CONTROL)
    ticks = round(duration * rate)
    count = ticks * hold
    robot = _Walker(plant, chain, stand, seed)
    n, m = plant.drives.joint_from_motor.shape
    recorded = {name: np.zeros((count, *shape)) for name, shape in robot.columns(n, m).items()}
    targets = np.zeros((ticks, n))
    before = after = robot.first
    for tick in range(-lead, count):
        row, within = divmod(tick, hold)
        if within == 0:
            before, after = after, robot.asked(row / rate)
            if tick >= 0:
                targets[row] = before
        # The drives run from one target to the next, which smooths the steps between the host's
        # ticks.
        values = robot.control(tick, before + (after - before) * (within / hold))
        if tick >= 0:
            for name, value in (values | robot.sensed()).items():
                recorded[name][tick] = value
        for _ in range(CONTROL_STEPS):
            robot.step()
        if robot.fell:
            break
    return WalkingTrace(
        time=np.arange(count) * CONTROL,
        targets=targets,
        voltage=np.full(count, plant.drives.voltage),
        fell=robot.fell,
        **recorded,
    )


class _Walker:
    """A robot, its drives, and where they are."""

    def __init__(self, plant: WalkingPlant, chain: Chain, stand: Stand, seed: int) -> None:
        import mujoco

        model, drives = plant.model, plant.drives
        self.plant, self.model, self.drives, self.stand = plant, model, drives, stand
        self.data = data = mujoco.MjData(model)
        n, m = drives.joint_from_motor.shape
        joints = [model.joint(name) for name in chain.joints]
        assert [joint.qposadr[0] for joint in joints] == list(range(7, 7 + n))
        assert [joint.dofadr[0] for joint in joints] == list(range(6, 6 + n))
        self.sides = _sides(model, chain)
        self.root = model.body("pelvis").id
        self.ankles = [model.body(f"{side}_foot").id for side in ("left", "right")]
        self.pads = [model.geom(name).id for name in pad_names(model)]
        self.allot = np.linalg.pinv(drives.declared)
        self.inverse_rotor = 1.0 / drives.rotor_inertia
        self.lag = -np.expm1(-STEP / np.maximum(drives.lag, 1e-6))
        self.smooth = -np.expm1(-2 * np.pi * drives.velocity_bandwidth * CONTROL)
        self.line = DelayLine(drives.delay[None], CONTROL)
        self.dice, self.silent = np.random.default_rng(seed), 0
        self.first = stand.targets(0.0, AHEAD, 0.0, 0.0, 0.0, self.sides)
        data.qpos[7:] = self.first
        mujoco.mj_kinematics(model, data)
        data.qpos[2] -= min(data.geom_xpos[g, 2] - model.geom_size[g, 0] for g in self.pads)
        mujoco.mj_forward(model, data)
        self.rotor, self.spin = drives.joint_from_motor.T @ data.qpos[7:], np.zeros(m)
        self.bristles, self.speed, self.current = np.zeros(n), np.zeros(n), np.zeros(m)
        self.wanted = np.zeros(m)

    def columns(self, n: int, m: int) -> dict[str, tuple[int, ...]]:
        """Shapes of what is recorded at each tick."""
        of_joints = dict.fromkeys(("encoder", "speed"), (n,))
        of_motors = dict.fromkeys(
            ("motor_velocity", "command", "drive_torque", "temperature"), (m,)
        )
        of_base = {"base": (10,), "gyro": (3,), "accelerometer": (3,)}
        return {**of_joints, **of_motors, **of_base, "contact": (len(self.pads), 3)}

    @property
    def fell(self) -> bool:
        """Whether the pelvis is too low, or nowhere."""
        height = self.data.qpos[2]
        return bool(height < FALLEN or not np.isfinite(height))

    def asked(self, time: float) -> np.ndarray:
        """Targets that the host sends, from how the robot stands `(n,)` [rad]."""
        import mujoco

        data, (left, right) = self.data, self.ankles
        middle = 0.5 * (data.xpos[left, 0] + data.xpos[right, 0])
        ahead = data.subtree_com[self.root, 0] - middle
        mujoco.mj_subtreeVel(self.model, data)
        speed = data.subtree_linvel[self.root, 0]
        roll = _roll(data.qpos[3:7])
        return self.stand.targets(time, ahead, speed, roll, data.qvel[3], self.sides)

    def control(self, tick: int, target: np.ndarray) -> dict[str, np.ndarray]:
        """Read the encoders, command the drives, push, and state what drives and encoders show."""
        own, data = self.drives, self.data
        encoder = data.qpos[7:] + own.offset + own.drift * max(tick * CONTROL, 0.0)
        encoder = np.round(encoder / own.resolution) * own.resolution
        self.speed = self.speed + self.smooth * (data.qvel[6:] - self.speed)
        fresh = self.allot @ (own.stiffness * (target - encoder) - own.damping * self.speed)
        chance = own.loss * CONTROL / (0.04 * (1 - own.loss))
        if own.loss and self.silent == 0 and self.dice.random() < chance:
            self.silent = 1 + int(self.dice.exponential(0.04) / CONTROL)
        arrived = self.line.send(tick, fresh[None], np.array([[self.silent > 0]]))[0]
        self.silent = max(self.silent - 1, 0)
        self.wanted = np.clip(arrived, -own.peak_torque, own.peak_torque)
        thrust = max(np.sin(2 * np.pi * own.push_frequency * tick * CONTROL), 0.0) ** 6
        data.xfrc_applied[self.root, :3] = self.plant.push * thrust
        return {
            "encoder": encoder,
            "speed": self.speed,
            "motor_velocity": self.spin,
            "command": fresh,
            "drive_torque": self.current,
            "temperature": own.start_temperature,
        }

    def sensed(self) -> dict[str, np.ndarray]:
        """Base, IMU and the forces on the pads."""
        data, model = self.data, self.model
        gyro, accelerometer = (model.sensor(name).adr[0] for name in ("gyro", "accelerometer"))
        return {
            "base": np.concatenate([data.qpos[:7], data.qvel[:3]]),
            "gyro": data.sensordata[gyro : gyro + 3] + self.plant.gyro_bias,
            "accelerometer": data.sensordata[accelerometer : accelerometer + 3]
            + self.plant.accelerometer_bias,
            "contact": self.contact(),
        }

    def contact(self) -> np.ndarray:
        """Force of the ground on each pad, in the world `(pads, 3)` [N]."""
        import mujoco

        forces, wrench = np.zeros((len(self.pads), 3)), np.zeros(6)
        pad_of = {geom: place for place, geom in enumerate(self.pads)}
        for number in range(self.data.ncon):
            touch = self.data.contact[number]
            pad = pad_of.get(touch.geom2, pad_of.get(touch.geom1))
            if pad is not None:
                mujoco.mj_contactForce(self.model, self.data, number, wrench)
                force = touch.frame.reshape(3, 3).T @ wrench[:3]
                forces[pad] += force if touch.geom2 in pad_of else -force
        return forces

    def step(self) -> None:
        """One step of belts, rotors and friction, and of MuJoCo."""
        import mujoco

        own, matrix, data = self.drives, self.drives.joint_from_motor, self.data
        self.current = self.current + self.lag * (self.wanted - self.current)
        q, qd = data.qpos[7:], data.qvel[6:]
        taut = self.rotor - q @ matrix
        pull = own.belt_stiffness * taut + own.belt_damping * (self.spin - qd @ matrix)
        data.qfrc_applied[6:] = (
            matrix @ pull - self.friction(qd) - own.spring * (q - own.spring_rest)
        )
        torque = own.torque_scale * self.current - pull
        self.spin = self.spin + STEP * self.inverse_rotor * torque
        self.rotor = self.rotor + STEP * self.spin
        mujoco.mj_step(self.model, data)

    def friction(self, qd: np.ndarray) -> np.ndarray:
        """LuGre friction of the joints after one step `(n,)` [Nm]."""
        own, joints = self.drives, slice(len(self.spin), None)
        coulomb, static, bristle = own.coulomb[joints], own.static[joints], own.bristle[joints]
        size = np.maximum(static, 1e-9)
        level = np.exp(-((qd / own.stribeck_speed[joints]) ** 2))
        capacity = coulomb + (static - coulomb) * level + 1e-12
        bristles = (self.bristles + STEP * qd / bristle) / (
            1 + STEP * np.abs(qd) * size / (bristle * capacity)
        )
        rates = BRISTLE_DAMPING / STEP * (bristles - self.bristles)
        self.bristles = bristles
        return size * (bristles + rates) + own.viscous[joints] * qd


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
