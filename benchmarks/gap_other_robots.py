"""Diagnosis of robots that are not ours: a serial arm, a leg on a rig and a leg with coupled
motors, simulated by plain MuJoCo loops.

Nothing of the package makes the logs: MJCF as other people write it (torque motors, gears, fixed
tendons), controllers at 200 Hz on a simulation at 1 kHz, masses 1.5 %, friction 8 % and zeros 1
mrad off, noisy sensors. Each case has two logs, and with `references` two of the healthy robot.
These cases were seen in development: they are a check against mistakes, no blind trial.

    python benchmarks/gap_other_robots.py --logs all --references
    python benchmarks/gap_other_robots.py --logs targets --references     # positions and targets alone
"""  # noqa: E501

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import mujoco
import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.pipeline.diagnose import diagnose

STEP, TICKS, DURATION = 0.001, 5, 14.0
"""Of the simulation [s]; its steps in one of controller and log; length of a log [s]."""
HEAD = """<mujoco model="%s"><compiler angle="radian"/><option timestep="0.001" integrator="implicitfast"/>
<default><geom contype="0" conaffinity="0"/></default><worldbody>"""  # noqa: E501
ARM = (
    (HEAD % "arm")
    + """<body name="base" pos="0 0 .3"><geom type="cylinder" size=".05 .1" mass="3"/>
<body name="turret" pos="0 0 .12"><joint name="yaw" axis="0 0 1" range="-2.9 2.9" damping=".3" frictionloss=".4" armature=".05"/>
<geom type="capsule" fromto="0 0 0 0 0 .1" size=".045" mass="2.2"/>
<body name="upper" pos="0 0 .1"><joint name="shoulder" axis="0 1 0" range="-2 2" damping=".35" frictionloss=".5" armature=".06"/>
<geom type="capsule" fromto="0 0 0 0 0 .32" size=".04" mass="2.6"/>
<body name="fore" pos="0 0 .32"><joint name="elbow" axis="0 1 0" range="-2.5 2.5" damping=".2" frictionloss=".3" armature=".03"/>
<geom type="capsule" fromto="0 0 0 0 0 .27" size=".03" mass="1.4"/>
<body name="hand" pos="0 0 .27"><joint name="wrist" axis="0 1 0" range="-2 2" damping=".05" frictionloss=".08" armature=".01"/>
<geom type="box" size=".03 .03 .06" pos="0 0 .06" mass=".5"/></body></body></body></body></body></worldbody>
<actuator><motor name="m_yaw" joint="yaw" ctrlrange="-40 40"/><motor name="m_shoulder" joint="shoulder" ctrlrange="-60 60"/>
<motor name="m_elbow" joint="elbow" ctrlrange="-40 40"/><motor name="m_wrist" joint="wrist" ctrlrange="-12 12"/></actuator></mujoco>"""  # noqa: E501
)
LIMB = """<body name="rig" pos="0 0 1.2"><geom type="box" size=".1 .1 .05" mass="5"/>
<body name="hip" pos="0 .05 -.05"><joint name="hip_roll" axis="1 0 0" range="-.6 .6" damping=".4" frictionloss=".6" armature=".08"/>
<geom type="box" size=".05 .04 .05" mass="1.5"/>
<body name="thigh" pos="0 0 -.06"><joint name="hip_pitch" axis="0 1 0" range="-1.6 1.6" damping=".5" frictionloss=".7" armature=".09"/>
<geom type="capsule" fromto="0 0 0 0 0 -.36" size=".05" mass="3.8"/>
<body name="shank" pos="0 0 -.36"><joint name="knee" axis="0 1 0" range="0 2.3" damping=".3" frictionloss=".5" armature=".05"/>
<geom type="capsule" fromto="0 0 0 0 0 -.36" size=".035" mass="1.9"/>
<body name="foot" pos="0 0 -.36"><joint name="ankle" axis="0 1 0" range="-.9 .9" damping=".12" frictionloss=".2" armature=".015"/>
<geom type="box" size=".1 .04 .015" pos=".03 0 -.04" mass=".8"/></body></body></body></body></body></worldbody>"""  # noqa: E501
HIPS = """<motor name="m_roll" joint="hip_roll" gear="9" ctrlrange="-12 12"/><motor name="m_pitch" joint="hip_pitch" gear="9" ctrlrange="-12 12"/>"""  # noqa: E501
LEG = (
    (HEAD % "leg")
    + LIMB
    + f"""<actuator>{HIPS}<motor name="m_knee" joint="knee" gear="9" ctrlrange="-12 12"/>
<motor name="m_ankle" joint="ankle" gear="9" ctrlrange="-6 6"/></actuator></mujoco>"""
)
COUPLED = (
    (HEAD % "coupled")
    + LIMB
    + f"""<tendon><fixed name="t_a"><joint joint="knee" coef="8"/><joint joint="ankle" coef="6"/></fixed>
<fixed name="t_b"><joint joint="knee" coef="8"/><joint joint="ankle" coef="-6"/></fixed></tendon>
<actuator>{HIPS}<motor name="m_a" tendon="t_a" ctrlrange="-8 8"/><motor name="m_b" tendon="t_b" ctrlrange="-8 8"/></actuator></mujoco>"""  # noqa: E501
)


@dataclass(frozen=True)
class Robot:
    """MJCF, gains, middle of the motion and its size, by joint."""

    xml: str
    stiffness: tuple[float, ...]
    damping: tuple[float, ...]
    middle: tuple[float, ...]
    swing: tuple[float, ...]


LEG_ROBOT = Robot(
    LEG, (150, 180, 150, 40), (5, 6, 5, 1.2), (0, -0.4, 0.8, -0.2), (0.25, 0.5, 0.6, 0.4)
)
ROBOTS = {
    "arm": Robot(ARM, (60, 120, 70, 12), (3, 6, 3, 0.5), (0, 0.5, 0.7, 0), (0.9, 0.7, 0.8, 0.6)),
    "leg": LEG_ROBOT,
    "coupled": replace(LEG_ROBOT, xml=COUPLED),
}


@dataclass(frozen=True)
class Case:
    """What is wrong with a robot, and what a diagnosis should say."""

    robot: str
    wrong: str
    place: int = 0
    """Joint or motor."""
    size: float = 0.0
    right: tuple[str, ...] = ()
    """Names of the effect, any of which is right; none of what the catalogue lacks."""
    where: tuple[str, ...] = ()
    body: str = ""
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)


KT = ("torque_constant", "transmission_ratio", "controller_gain")
"""Of a weak motor: logs without rotor speeds or measured torques cannot tell them apart, and say
so."""
BELT = ("transmission_elasticity", "backlash")
"""Of a belt that gives: without rotor speeds a spring and play may look alike."""
LOAD = ("payload", "link_mass")
CASES = [
    *(Case(robot, "nothing") for robot in ROBOTS),
    Case("arm", "load", size=0.8, right=LOAD, where=("hand", "wrist"), body="hand", at=(0, 0, 0.1)),
    Case("arm", "load", size=0.6, right=LOAD, where=("fore", "elbow"), body="fore", at=(0, 0, 0.2)),
    Case("arm", "dry", 2, 1.2, ("coulomb_friction",), ("elbow",)),
    Case("arm", "viscous", 1, 2.0, ("viscous_friction", "controller_gain"), ("shoulder",)),
    Case("arm", "weak", 1, 0.85, KT, ("shoulder", "m_shoulder")),
    Case("arm", "late", size=0.01, right=("command_delay",), where=("robot",)),
    Case("arm", "zero", 1, 0.06, ("encoder_offset",), ("shoulder",)),
    Case("arm", "gain", 2, 0.7, ("controller_gain",), ("elbow",)),
    Case("arm", "rotor", 1, 0.25, ("rotor_inertia",), ("shoulder", "m_shoulder")),
    Case("arm", "spring", 2, 5.0, ("joint_spring",), ("elbow",)),
    Case("arm", "breakaway", 1, 2.0, ("stribeck_friction",), ("shoulder",)),
    Case("arm", "limit", 1, 8.0, ("torque_saturation",), ("shoulder", "m_shoulder")),
    Case(
        "leg",
        "load",
        size=0.8,
        right=LOAD,
        where=("foot", "ankle"),
        body="foot",
        at=(0.03, 0, -0.04),
    ),
    Case("leg", "dry", 2, 2.0, ("coulomb_friction",), ("knee",)),
    Case("leg", "viscous", 3, 0.6, ("viscous_friction", "controller_gain"), ("ankle",)),
    Case("leg", "weak", 2, 0.8, KT, ("knee", "m_knee")),
    Case("leg", "late", size=0.01, right=("command_delay",), where=("robot",)),
    Case("leg", "zero", 1, 0.06, ("encoder_offset",), ("hip_pitch",)),
    Case("leg", "gain", 3, 0.6, ("controller_gain",), ("ankle",)),
    Case("leg", "rotor", 2, 0.3, ("rotor_inertia",), ("knee", "m_knee")),
    Case("leg", "lossy", 1, 0.2, ("load_dependent_friction",), ("hip_pitch",)),
    Case("coupled", "weak", 2, 0.8, KT, ("m_a",)),
    Case("coupled", "dry", 3, 1.2, ("coulomb_friction",), ("ankle",)),
    Case(
        "coupled",
        "load",
        size=0.8,
        right=LOAD,
        where=("foot", "ankle"),
        body="foot",
        at=(0.03, 0, -0.04),
    ),
    Case("coupled", "limit", 2, 1.0, ("torque_saturation",), ("m_a",)),
    Case("coupled", "late", size=0.01, right=("command_delay",), where=("robot",)),
    Case("coupled", "zero", 3, 0.06, ("encoder_offset",), ("ankle",)),
    Case("arm", "tilt", size=0.1),
    Case("arm", "drag", 1, 1.5),
    Case("arm", "hysteresis", 1, 3.0),
    Case("arm", "push", 2, 3.0),
    Case("arm", "patch", 1, 3.0),
    Case("arm", "lost commands", size=0.3),
    Case("arm", "ripple", 1, 0.25),
    Case("leg", "hysteresis", 2, 3.0),
    Case("leg", "patch", 2, 3.0),
    Case("coupled", "hysteresis", 2, 3.0),
    Case("coupled", "ripple", 3, 0.3),
    Case("arm", "soft", 1, 12.0, BELT, ("shoulder", "m_shoulder")),
    Case("arm", "play", 2, 0.03, BELT, ("elbow", "m_elbow")),
    Case("leg", "soft", 2, 14.0, BELT, ("knee", "m_knee")),
    Case("leg", "play", 1, 0.02, BELT, ("hip_pitch", "m_pitch")),
]


def motion(robot: Robot, rng: np.random.Generator) -> np.ndarray:
    """Targets of slow and fast swings with pauses `(t, n)` [rad]."""
    clock = np.arange(int(DURATION / STEP)) * STEP
    found = []
    for middle, swing in zip(robot.middle, robot.swing, strict=True):
        wave = np.full_like(clock, middle)
        for frequency, share in (
            (rng.uniform(0.12, 0.25), 0.5),
            (rng.uniform(0.4, 0.8), 0.35),
            (rng.uniform(1.2, 2.2), 0.1),
        ):
            wave += (
                swing * share * np.sin(2 * np.pi * frequency * clock + rng.uniform(0, 2 * np.pi))
            )
        pause = clock % 5 > 4.2
        begun = np.maximum.accumulate(
            np.where(pause & ~np.roll(pause, 1), np.arange(len(clock)), 0)
        )
        wave = np.where(pause, wave[begun], wave)
        wave = middle + (wave - middle) * np.clip(clock / 0.5, 0, 1)
        window = np.hanning(81) / np.hanning(81).sum()
        found.append(np.convolve(np.pad(wave, 40, "edge"), window, "valid"))
    return np.array(found).T


def simulate(robot: Robot, case: Case, seed: int, build: int) -> np.ndarray:
    """Rows of time, targets, positions, velocities, commanded and given motor torques; `build` is
    of the robot, `seed` of the day.
    """
    model, own = mujoco.MjModel.from_xml_string(robot.xml), np.random.default_rng(build)
    moment = _moment(model)
    to_motor, limit = np.linalg.inv(moment.T), model.actuator_ctrlrange[:, 1].copy()
    model.body_mass[:] *= 1 + 0.015 * own.normal(size=model.nbody)
    model.dof_frictionloss[:] *= 1 + 0.08 * own.normal(size=model.nv)
    model.dof_damping[:] *= 1 + 0.08 * own.normal(size=model.nv)
    zero, gains, weak, j, x = (
        0.001 * own.normal(size=4),
        np.array(robot.stiffness, float),
        np.ones(4),
        case.place,
        case.size,
    )
    if case.wrong == "load":
        _load(model, model.body(case.body).id, x, np.array(case.at))
    if case.wrong == "rotor":
        model.dof_armature[j] += x
    if case.wrong == "tilt":
        model.opt.gravity[:] = 9.81 * np.array([np.sin(x), 0, -np.cos(x)])
    zero[j] += x if case.wrong == "zero" else 0.0
    gains[j] *= x if case.wrong == "gain" else 1.0
    weak[j] = x if case.wrong == "weak" else 1.0
    limit[j] = x if case.wrong == "limit" else limit[j]
    belt = _Belt(case, float(model.dof_armature[j])) if case.wrong in ("soft", "play") else None
    if belt is not None:
        model.dof_armature[j] = 0.0
    mujoco.mj_setConst(model, mujoco.MjData(model))
    rng, data, bristle = np.random.default_rng(seed), mujoco.MjData(model), 0.0
    target, middle, past, rows = motion(robot, rng), np.array(robot.middle), [], []
    data.qpos[:] = target[0]
    if belt is not None:
        belt.angle = float(target[0, j])
    late = round(x / STEP / TICKS) if case.wrong == "late" else 0
    for tick, wanted in enumerate(target):
        q, v = data.qpos, data.qvel
        if tick % TICKS == 0:
            past.append(to_motor @ (gains * (wanted - q - zero) - np.array(robot.damping) * v))
            lost = case.wrong == "lost commands" and rng.uniform() < x
            given = np.clip(
                past[max(0, len(past) - 1 - (late or (1 + rng.integers(0, 6) if lost else 0)))],
                -limit,
                limit,
            )
            rows.append(np.r_[tick * STEP, wanted, q + zero, v, past[-1], given])
        torque = given * weak
        if case.wrong == "ripple":
            torque[j] *= 1 + x * np.sin(14 * float(moment[j] @ q))
        rubs = np.tanh(v[j] / 0.02)
        bristle += STEP * (v[j] - abs(v[j]) * bristle) / 0.05
        data.ctrl[:], data.qfrc_applied[:] = torque, 0.0
        data.qfrc_applied[j] = {
            "dry": -x * rubs,
            "viscous": -x * v[j],
            "spring": -x * (q[j] - middle[j]),
            "breakaway": -x * np.exp(-((v[j] / 0.1) ** 2)) * np.tanh(v[j] / 0.01),
            "lossy": -x * abs(float((moment.T @ torque)[j])) * rubs,
            "drag": -x * abs(v[j]) * v[j],
            "hysteresis": -x * bristle,
            "push": x * float(np.sin(2 * np.pi * 0.9 * tick * STEP + 1) > 0.8),
            "patch": -x * np.exp(-(((q[j] - middle[j] - 0.1) / 0.08) ** 2)) * rubs,
        }.get(case.wrong, 0.0)
        if belt is not None:
            data.ctrl[j], data.qfrc_applied[j] = (
                0.0,
                belt.pull(float((moment.T @ torque)[j]), float(q[j]), float(v[j])),
            )
        mujoco.mj_step(model, data)
    table, noise = np.array(rows), np.random.default_rng(seed + 1)
    table[:, 5:9] += 5e-5 * noise.normal(size=(len(table), 4))
    table[:, 9:13] += 4e-3 * noise.normal(size=(len(table), 4))
    table[:, 17:21] += 0.004 * model.actuator_ctrlrange[:, 1] * noise.normal(size=(len(table), 4))
    return table


class _Belt:
    """A rotor between its torque and its joint, on a spring of `size` Hz (the joint held) or with a
    play of `size` rad, at the joint.
    """

    def __init__(self, case: Case, inertia: float) -> None:
        self.angle, self.speed, self.inertia = 0.0, 0.0, inertia
        frequency, self.half = (case.size, 0.0) if case.wrong == "soft" else (60.0, case.size / 2)
        self.stiffness = inertia * (2 * np.pi * frequency) ** 2
        self.damping = 0.1 * np.sqrt(self.stiffness * inertia)

    def pull(self, torque: float, place: float, speed: float) -> float:
        """Mean torque on the joint over a step of the simulation [Nm]."""
        total, parts = 0.0, 20
        for part in range(parts):
            stretch = self.angle - place - speed * STEP * part / parts
            taut = stretch - min(max(stretch, -self.half), self.half)
            given = self.stiffness * taut + (
                self.damping * (self.speed - speed) if taut or not self.half else 0.0
            )
            self.speed += STEP / parts * (torque - given) / self.inertia
            self.angle += STEP / parts * self.speed
            total += given / parts
        return total


def _moment(model: mujoco.MjModel) -> np.ndarray:
    data, dense = mujoco.MjData(model), np.zeros((model.nu, model.nv))
    mujoco.mj_forward(model, data)
    mujoco.mju_sparse2dense(
        dense, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind
    )
    return dense


def _load(model: mujoco.MjModel, body: int, mass: float, at: np.ndarray) -> None:
    """A point mass on a body."""
    old, centre = float(model.body_mass[body]), model.body_ipos[body].copy()
    model.body_inertia[body] += (
        mass * old / (mass + old) * float((at - centre) @ (at - centre)) * np.array([1, 1, 0.02])
    )
    model.body_ipos[body], model.body_mass[body] = (
        (old * centre + mass * at) / (old + mass),
        old + mass,
    )


def logged(robot: Robot, table: np.ndarray, kind: str, name: str, role: str) -> Log:
    """A log of what a simulation gave: `all`, `torques` without commands, or `targets` without
    torques.
    """
    model = mujoco.MjModel.from_xml_string(robot.xml)
    signals: dict[str, np.ndarray] = {}
    joints = [model.joint(i).name for i in range(model.njnt)]
    for i, joint in enumerate(joints):
        signals |= {
            f"{k}/{joint}": table[:, first + i]
            for k, first in {"position_target": 1, "position": 5, "velocity": 9}.items()
        }
    for i in range(model.nu):
        signals |= (
            {f"motor_torque_command/{model.actuator(i).name}": table[:, 13 + i]}
            if kind == "all"
            else {}
        )
        signals |= (
            {f"motor_torque/{model.actuator(i).name}": table[:, 17 + i]}
            if kind != "targets"
            else {}
        )
    gains = {
        joint: (float(k), float(d))
        for joint, k, d in zip(joints, robot.stiffness, robot.damping, strict=True)
    }
    return Log(name, table[:, 0], signals, Metadata(gains=gains, session=role, role=role))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--logs", choices=("all", "torques", "targets"), default="all")
    parser.add_argument("--references", action="store_true")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--only", default="", help="cases whose `wrong` this is")
    options = parser.parse_args()
    counts: dict[str, list[bool]] = {}
    print("| robot | wrong | size | said | right | s |\n|---|---|---|---|---|---|")
    for number, case in enumerate(CASES):
        if options.only not in ("", case.wrong):
            continue
        robot, healthy = ROBOTS[case.robot], Case(case.robot, "nothing")
        with TemporaryDirectory() as folder:
            path = Path(folder) / f"{case.robot}.xml"
            path.write_text(robot.xml)
            build = 77 + number
            tests = [
                logged(
                    robot,
                    simulate(robot, case, 1000 * number + k, build),
                    options.logs,
                    f"log_{k}",
                    "test",
                )
                for k in (0, 1)
            ]
            references = [
                logged(
                    robot,
                    simulate(robot, healthy, 1000 * number + k, build),
                    options.logs,
                    f"healthy_{k}",
                    "reference",
                )
                for k in ((2, 3) if options.references else ())
            ]
            start = time.perf_counter()
            found = diagnose(path, tests, references, threads=options.threads)
        first = found.causes[0] if found.causes else None
        kind = (
            "healthy"
            if case.wrong == "nothing"
            else "in the catalogue"
            if case.right
            else "outside it"
        )
        right = found.verdict == {"healthy": "none", "outside it": "unknown"}.get(kind)
        if case.right and first is not None:
            right = first.effect in case.right and first.location in case.where
        counts.setdefault(kind, []).append(right)
        said = found.verdict + "".join(f"; {c.effect} at {c.location}" for c in found.causes)
        took = time.perf_counter() - start
        print(
            f"| {case.robot} | {case.wrong} | {case.size:g} | {said} | {'yes' if right else 'no'} "
            f"| {took:.1f} |",
            flush=True,
        )
    print("\n" + ", ".join(f"{sum(v)} of {len(v)} {kind}" for kind, v in counts.items()))


if __name__ == "__main__":
    main()
