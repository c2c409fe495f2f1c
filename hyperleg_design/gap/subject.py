"""The robot that logs are diagnosed against: its nominal model, from a design of ours or from anybody's MJCF or URDF."""

from __future__ import annotations

import dataclasses
import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.gap import robot_file
from hyperleg_design.gap.mechanism import BASE, Mechanism, mechanism_of, pinocchio_model
from hyperleg_design.gap.metadata import STANDARD_GRAVITY, Metadata

if TYPE_CHECKING:
    import mujoco
    import pinocchio

    from hyperleg_design.gap.log import Log
    from hyperleg_design.robot.design import Design

FRICTION_SPEED = 0.02
"""Width of the tanh that stands for MuJoCo's `frictionloss` [rad/s]: assumed; a sign, softened below the speeds that logs resolve."""


@dataclass(frozen=True)
class Pad:
    """A place that may touch the ground."""

    name: str
    foot: int
    """Of `Subject.feet`."""
    link: int
    """Of `Mechanism.links`."""
    position: tuple[float, float, float]
    """Of its centre in the link's frame [m]."""
    radius: float
    """[m]"""


@dataclass(frozen=True, eq=False)
class Subject:
    """Nominal robot: `n` joints, `m` motors; tau_joint = joint_from_motor tau_motor, motor speed = its transpose times joint speed."""

    name: str
    path: str
    """File it was read from."""
    design: Design | None
    """Where it is one of ours."""
    base: str
    """`fixed` or `floating`."""
    gravity: np.ndarray
    """In the world `(3,)` [m/s^2]."""
    joints: tuple[str, ...]
    motors: tuple[str, ...]
    """Named as the joints where they are one to one."""
    motor_aliases: tuple[str, ...]
    """Other names under which logs may know the motors, those of the file's actuators `(m,)`."""
    feet: tuple[str, ...]
    pads: tuple[Pad, ...]
    joint_from_motor: np.ndarray
    """`(n, m)` [-]."""
    gains: np.ndarray
    """Stiffness and damping of the joint controllers, NaN where unknown `(n, 2)` [Nm/rad, Nms/rad]."""
    torque_limit: np.ndarray
    """Largest motor torque, infinite where unknown `(m,)` [Nm]."""
    stall_torque: np.ndarray
    """Of the DC-motor line, infinite where unknown `(m,)` [Nm]."""
    no_load_speed: np.ndarray
    """Of the DC-motor line, infinite where unknown `(m,)` [rad/s]."""
    rotor_inertia: np.ndarray
    """At the motors `(m,)` [kg m^2]."""
    armature: np.ndarray
    """Inertia that rotors add at the joints, coupling included `(n, n)` [kg m^2]."""
    coulomb: np.ndarray
    viscous: np.ndarray
    """Nominal friction of the joints `(n,)` [Nm, Nms/rad]: coulomb tanh(v / friction_speed) + viscous v."""
    friction_speed: np.ndarray
    """`(n,)` [rad/s]."""
    spring: np.ndarray
    spring_rest: np.ndarray
    """Springs of the file at the joints: stiffness and position at rest `(n,)` [Nm/rad, rad]."""
    torque_constant: np.ndarray
    """NaN where unknown `(m,)` [Nm/A]."""
    passive: np.ndarray
    """Joints without a drive `(n,)`."""
    position_low: np.ndarray
    position_high: np.ndarray
    """Range of motion, infinite where unlimited `(n,)` [rad]."""
    default: np.ndarray
    """Posture at rest `(n,)` [rad]."""
    model: mujoco.MjModel
    """Of the same robot without actuators and friction; torques go in through `qfrc_applied`. Rotors are in it."""
    tree: Mechanism
    imu_rotation: np.ndarray
    imu_position: np.ndarray
    """Where gyro and accelerometer sit: axes `(3, 3)` and place `(3,)` [m] in the base's frame."""
    unlogged: tuple[str, ...]
    """Joints that no log knows, held still where the file draws them."""
    notes: tuple[str, ...]
    declared: Metadata
    """What was declared of it: gains, torque constants, payload."""
    bare: Subject | None
    """The same before anything was declared."""

    @property
    def links(self) -> tuple[str, ...]:
        """Links that can move."""
        return self.tree.links

    @property
    def floating(self) -> bool:
        """Whether the base floats."""
        return self.base == "floating"

    @property
    def one_to_one(self) -> bool:
        """Whether each motor drives the joint of its own name."""
        return self.motors == self.joints

    @cached_property
    def motor_from_joint(self) -> np.ndarray:
        """Motor torques that give joint torques with the least sum of squares `(m, n)`."""
        if self.design is not None and self.joint_from_motor.shape[0] != self.joint_from_motor.shape[1]:
            return _least_heat(self)
        return np.asarray(np.linalg.pinv(self.joint_from_motor))

    @cached_property
    def pinocchio(self) -> pinocchio.Model:
        """Pinocchio model of the same tree, see `mechanism.pinocchio_model`."""
        return pinocchio_model(self.tree, self.gravity)

    def declare(self, metadata: Metadata) -> Subject:
        """The same robot with the gains, torque constants, payload and gravity that one log declares.

        Raises:
            InputError: a joint, motor or link that the robot does not have.
        """
        keys = ("gains", "torque_constant", "payload", "gravity")
        if all(getattr(self.declared, k) == getattr(metadata, k) for k in keys) and self.bare is not None:
            return self
        return _declared(self.bare or self, metadata)


def load_subject(robot: str | Path | None = None, logs: Sequence[Log] = (), *, overrides: Iterable[str] | None = None) -> Subject:
    """Nominal model of a robot, made to fit logs.

    Args:
        robot: a design of ours (`hyperleg`, or a YAML file), or any MJCF or URDF file; by default what the logs' metadata name.
        logs: whose metadata say what holds the base, gains, torque constants and payload; joints that none of them knows are
            held still. What differs between logs is taken from the first here, and from each in `conditioning.condition`.
        overrides: of our design, `path=value` each; by default those of the logs.

    Raises:
        InputError: no such robot, a joint or motor of a log that it does not have, logs that contradict each other, a file that
            cannot be understood.
    """
    metadata = [log.metadata for log in logs]
    robot = str(robot) if robot else _agreed([m.robot for m in metadata], "robot", logs)
    base = _agreed([m.base for m in metadata], "base", logs)
    if not robot:
        raise InputError("robot", "", None, "is not named: give --robot a design, an MJCF or a URDF, or name it in the logs' metadata")
    chosen = tuple(overrides) if overrides is not None else next((m.overrides for m in metadata if m.overrides), ())
    path = _find(robot, logs)
    known = set().union(*(log.joints for log in logs)) if logs else None
    if path.suffix.lower() in (".yaml", ".yml"):
        from hyperleg_design.robot.design import load_design

        bare = _of_design(load_design(path, overrides=chosen), path, base or "floating", known)
    else:
        if chosen:
            raise InputError(robot, "overrides", chosen[0], "belong to designs of ours; edit the file instead")
        bare = _of_file(path, base or None, known)
    for log in logs:
        _check_names(log, bare)
    return bare.declare(metadata[0]) if metadata else dataclasses.replace(bare, bare=bare)


def _agreed(values: Sequence[str], field: str, logs: Sequence[Log]) -> str:
    stated = {v: log.name for v, log in zip(values, logs, strict=True) if v}
    if len(stated) > 1:
        found = ", ".join(f"{v} ({name})" for v, name in stated.items())
        raise InputError("logs", field, found, "differ: diagnose logs of one robot at a time")
    return next(iter(stated), "")


def _find(robot: str, logs: Sequence[Log]) -> Path:
    """File of a robot: as it stands, beside the logs that name it, or a shipped design."""
    path = Path(robot)
    folders = [Path(log.folder) for log in logs if log.folder]
    for place in (path, *(folder / path for folder in folders)):
        if place.suffix.lower() in (".xml", ".mjcf", ".urdf", ".yaml", ".yml") and place.is_file():
            return place
    if path.suffix.lower() in (".xml", ".mjcf", ".urdf"):
        raise InputError("robot", "", robot, "no such file")
    return resources.find("descriptions", robot)


def subject_of(design: Design) -> Subject:
    """Nominal model of one of our robots as it stands in memory, its base floating."""
    bare = _of_design(design, Path(f"{design.name}.yaml"), "floating", None)
    return dataclasses.replace(bare, bare=bare)


def _of_design(design: Design, path: Path, base: str, known: set[str] | None) -> Subject:
    from hyperleg_design.robot import transmission
    from hyperleg_design.robot.friction import FRICTION_SPEED as DESIGN_FRICTION_SPEED
    from hyperleg_design.robot.motors import find_motor, motor_arrays
    from hyperleg_design.robot.names import ACTUATOR_OF_MOTOR, SIDES
    from hyperleg_design.robot.tree import build_tree
    from hyperleg_design.simulation.model import simulation_spec
    from hyperleg_design.sizing.envelope import motor_envelope

    moving = [j for j in build_tree(design).moving if known is None or j.name in known]
    every = [j.name for j in build_tree(design).moving]
    if not moving:
        raise InputError(design.name, "joints", sorted(known or ())[:8], f"are joints of another robot; its own are {', '.join(every)}")
    matrix, names = transmission.joint_from_motor(design), transmission.motor_names(design)
    full = np.kron(np.eye(2), matrix)
    kept = [every.index(j.name) for j in moving]
    motors = [f"{side}_{name}" for side in SIDES for name in names]
    used = np.flatnonzero(np.any(full[kept] != 0, 0))
    arrays, envelope = motor_arrays(design), motor_envelope(design)

    def of_motors(values: np.ndarray) -> np.ndarray:
        return np.tile(np.asarray(values, float)[: len(names)], 2)[used]

    constants = [find_motor(str(getattr(design.actuators, ACTUATOR_OF_MOTOR[i]).motor)).torque_constant for i in range(len(names))]
    full = full[np.array(kept)][:, used]
    spec = simulation_spec(design)
    robot_file.strip_drives(spec)
    for group in (spec.sensors, spec.keys):
        for item in list(group):
            spec.delete(item)
    for joint in spec.joints:
        joint.frictionloss = 0.0
    robot_file.set_base(spec, base, path)
    held = robot_file.lock(spec, [j.name for j in moving])
    rotor = of_motors(arrays.rotor_inertia)
    used_names = tuple(motors[i] for i in used)
    _add_rotors(spec, [j.name for j in moving], used_names, full, rotor)
    joints = {j.name: getattr(design.joints, j.name.split("_", 1)[1]) for j in moving}
    model = robot_file.compiled(spec, path)
    tree = mechanism_of(model)
    pads = _pads(model, tree, None)
    feet = tuple(f"{side}_foot" for side in SIDES)
    pads = tuple(dataclasses.replace(p, foot=0 if p.name.startswith(SIDES[0]) else 1) for p in pads)
    return _assembled(
        name=design.name, path=path, design=design, base=base, model=model, tree=tree, matrix=full, motors=used_names, aliases=used_names,
        rotor=rotor,
        armature=np.zeros(len(moving)), gains=np.array([[j.stiffness, j.damping] for j in joints.values()], float),
        limit=of_motors(envelope.peak_torque), stall=of_motors(envelope.stall_torque), free=of_motors(envelope.no_load_speed),
        coulomb=np.array([j.coulomb for j in moving], float), viscous=np.array([j.viscous for j in moving], float),
        width=DESIGN_FRICTION_SPEED, constant=of_motors(np.array(constants)), passive=np.zeros(len(moving), bool),
        default=np.array([j.default for j in moving]), feet=feet, pads=pads, held=held, notes=(), imu=(np.eye(3), np.zeros(3)),
    )  # fmt: skip


def _of_file(path: Path, base: str | None, known: set[str] | None) -> Subject:
    spec = robot_file.read_spec(path)
    imu_site = robot_file.imu_site(spec)
    base = robot_file.set_base(spec, base, path)
    notes = robot_file.strip_scene(spec, path, contact=base == "floating")
    every = [j.name for j in spec.joints]
    if known is not None and not known & set(every):
        raise InputError(path.name, "joints", sorted(known)[:8], f"are joints of another robot; its own are {', '.join(every)}")
    drives = robot_file.read_drives(robot_file.compiled(spec, path), every if known is None else known)
    robot_file.strip_drives(spec)
    held = robot_file.lock(spec, every if known is None else known)
    if base == "floating":
        robot_file.add_floor(spec)
    first = robot_file.compiled(spec, path)
    tree = mechanism_of(first)
    coupled = drives.names != tree.joints
    used = np.any(drives.matrix != 0, 0)
    if coupled:
        _add_rotors(spec, tree.joints, [n for n, u in zip(drives.names, used, strict=True) if u], drives.matrix[:, used], drives.rotor_inertia[used])
    model = robot_file.compiled(spec, path)
    coulomb, viscous = robot_file.friction(model)
    spring, rest = robot_file.springs(model)
    names = tuple(n for n, u in zip(drives.names, used, strict=True) if u)
    aliases = tuple(n for n, u in zip(drives.aliases, used, strict=True) if u)
    unlimited = np.full(len(names), np.inf)
    feet, pads = _feet_of_file(model, tree) if base == "floating" else ((), ())
    return _assembled(
        name=path.stem, path=path, design=None, base=base, model=model, tree=tree, matrix=drives.matrix[:, used], motors=names, aliases=aliases,
        rotor=drives.rotor_inertia[used], armature=drives.armature, gains=drives.gains, limit=drives.limit[used], stall=unlimited, free=unlimited,
        coulomb=coulomb, viscous=viscous, width=FRICTION_SPEED, constant=np.full(len(names), np.nan), passive=drives.passive,
        default=tree.reference.copy(), feet=feet, pads=pads, held=held, notes=(*notes, *drives.notes), imu=robot_file.imu_place(model, imu_site),
        spring=spring, rest=rest,
    )  # fmt: skip


def _assembled(*, path: Path, model: Any, tree: Mechanism, matrix: np.ndarray, rotor: np.ndarray, armature: np.ndarray, **v: Any) -> Subject:
    count = tree.count
    robot_file.take_out_friction(model)
    low, high = robot_file.limits(model)
    notes = list(v["notes"])
    if v["held"]:
        notes.append(f"joints in no log, held still where the model draws them: {', '.join(v['held'])}")
    subject = Subject(
        name=v["name"], path=str(path), design=v["design"], base=v["base"], gravity=np.array(model.opt.gravity), joints=tree.joints,
        motors=v["motors"], motor_aliases=v["aliases"], feet=v["feet"], pads=v["pads"], joint_from_motor=matrix, gains=v["gains"],
        torque_limit=v["limit"], stall_torque=v["stall"], no_load_speed=v["free"], rotor_inertia=rotor,
        armature=(matrix * rotor) @ matrix.T + np.diag(armature), coulomb=v["coulomb"], viscous=v["viscous"],
        friction_speed=np.full(count, float(v["width"])), spring=v.get("spring", np.zeros(count)), spring_rest=v.get("rest", np.zeros(count)),
        torque_constant=v["constant"], passive=v["passive"], position_low=low, position_high=high, default=v["default"], model=model, tree=tree,
        imu_rotation=v["imu"][0], imu_position=v["imu"][1], unlogged=v["held"], notes=tuple(notes), declared=Metadata(), bare=None,
    )  # fmt: skip
    for value in vars(subject).values():
        if isinstance(value, np.ndarray):
            value.setflags(write=False)
    return subject


def _add_rotors(spec: Any, joints: Sequence[str], motors: Sequence[str], matrix: np.ndarray, rotor: np.ndarray) -> None:
    """Rotors of coupled motors, one fixed tendon each."""
    for column, motor in enumerate(motors):
        tendon = spec.add_tendon(name=motor, armature=rotor[column])
        for row in np.flatnonzero(matrix[:, column]).tolist():
            tendon.wrap_joint(joints[row], matrix[row, column])


def _pads(model: Any, tree: Mechanism, only: set[int] | None) -> tuple[Pad, ...]:
    """Spheres, ends of capsules and corners of boxes that collide on moving links."""
    found = []
    for geom in range(model.ngeom):
        body = int(model.geom_bodyid[geom])
        name = model.body(body).name or f"body_{body}"
        if name not in tree.links or not (model.geom_contype[geom] or model.geom_conaffinity[geom]) or (only is not None and body not in only):
            continue
        points, radius = robot_file.touching_points(model, geom)
        label = model.geom(geom).name or f"{name}_{geom}"
        for index, point in enumerate(points):
            title = label if len(points) == 1 else f"{label}_{index}"
            found.append(Pad(title, 0, tree.links.index(name), (float(point[0]), float(point[1]), float(point[2])), radius))
    return tuple(found)


def _feet_of_file(model: Any, tree: Mechanism) -> tuple[tuple[str, ...], tuple[Pad, ...]]:
    """Feet: the outermost links with shapes that collide."""
    names = [model.body(b).name or f"body_{b}" for b in range(model.nbody)]
    touching = {int(b) for b, *kinds in zip(model.geom_bodyid, model.geom_contype, model.geom_conaffinity, strict=True) if any(kinds)}
    outermost = set()
    for leaf in set(range(1, model.nbody)) - set(model.body_parentid.tolist()):
        body = leaf
        while body and body not in touching:
            body = int(model.body_parentid[body])
        if names[body] in tree.links and tree.link_joint[tree.links.index(names[body])] != BASE:
            outermost.add(body)
    pads = _pads(model, tree, outermost)
    feet = tuple(dict.fromkeys(tree.links[p.link] for p in pads))
    return feet, tuple(dataclasses.replace(p, foot=feet.index(tree.links[p.link])) for p in pads)


def _declared(bare: Subject, metadata: Metadata) -> Subject:
    gains, constant = np.array(bare.gains), np.array(bare.torque_constant)
    for joint, pair in metadata.gains.items():
        if joint in bare.unlogged:
            continue
        gains[_index(joint, bare.joints, "gains", "joint")] = pair
    for motor, value in metadata.torque_constant.items():
        constant[motor_index(bare, motor, "torque_constant")] = value
    values: dict[str, Any] = {"gains": gains, "torque_constant": constant, "declared": metadata, "bare": bare}
    moved = metadata.gravity != STANDARD_GRAVITY
    if metadata.payload or moved:
        import copy

        model = copy.copy(bare.model)
        for place, numbers in metadata.payload.items():
            link = bare.tree.link(place)
            robot_file.add_mass(model, bare.tree.links[link], numbers[0], np.array(numbers[1:]))
        if moved:
            model.opt.gravity[:] = metadata.gravity
            values["gravity"] = np.array(metadata.gravity)
        values |= {"model": model, "tree": mechanism_of(model)}
    return dataclasses.replace(bare, **values)


def motor_index(subject: Subject, motor: str, field: str) -> int:
    """Place of a motor, by its name or the name of its actuator in the file.

    Raises:
        InputError: no such motor.
    """
    if motor not in subject.motors and motor in subject.motor_aliases:
        return subject.motor_aliases.index(motor)
    return _index(motor, subject.motors, field, "motor")


def _index(name: str, names: Sequence[str], field: str, what: str) -> int:
    if name in names:
        return names.index(name)
    near = difflib.get_close_matches(name, names, n=1)
    remedy = f"did you mean {near[0]}?" if near else f"there are {', '.join(names)}"
    raise InputError("log", field, name, f"is no {what} of this robot; {remedy}")


def _check_names(log: Log, subject: Subject) -> None:
    for joint in log.names("position", "position_target", "velocity", "joint_torque"):
        if joint not in subject.unlogged:
            _index(joint, subject.joints, f"{log.name}: position", "joint")
    for motor in log.motors:
        if motor not in subject.unlogged:
            motor_index(subject, motor, f"{log.name}: motor")


def _least_heat(subject: Subject) -> np.ndarray:
    from hyperleg_design.robot.motors import motor_arrays
    from hyperleg_design.robot.transmission import motor_names
    from hyperleg_design.simulation.actuation import motor_from_joint

    assert subject.design is not None
    names = motor_names(subject.design)
    cost = [motor_arrays(subject.design).power_constant[names.index(m.split("_", 1)[1])] for m in subject.motors]
    return motor_from_joint(subject.joint_from_motor, np.array(cost))
