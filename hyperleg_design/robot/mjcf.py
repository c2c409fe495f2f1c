"""From a design to MuJoCo: the URDF's tree, a floating base, sole pads, sensors, and motors on
fixed tendons.

Each motor is one fixed tendon whose coefficients are that motor's column of `joint_from_motor`.
Torque on the tendon then reaches the joints as M tau_motor, the tendon's velocity is the motor's,
and its `armature`, the rotor inertia, appears at the joints as M diag(J) M^T, off-diagonal terms
included.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.robot import description, transmission
from hyperleg_design.robot.kinematics.dimensions import zero_height
from hyperleg_design.robot.kinematics.tree import Tree, build_tree
from hyperleg_design.robot.laws.gear import rotor_inertia
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.robot.parameters.described import prefixed
from hyperleg_design.robot.parameters.hyperleg import HyperLeg

if TYPE_CHECKING:
    import mujoco

    from hyperleg_design.robot.parameters.described import RobotDesign

TIME_STEP = 0.005
"""Simulation step [s]: 200 Hz (paper, Table II)."""
STOP_IMPEDANCE_SHAPE = (0.001, 0.5, 2.0)
"""Width [rad], midpoint and power of the impedance of stops over penetration; MuJoCo's defaults."""
FLOOR = "floor"
BASE_JOINT = "floating_base"
STAND = "stand"
"""Keyframe of the default posture, soles on the floor."""


def mujoco_spec(design: RobotDesign, *, friction: bool = True, floor: bool = True) -> mujoco.MjSpec:
    """Editable MuJoCo model of one robot.

    Args:
        design: the robot.
        friction: joint friction (Coulomb and viscous) by MuJoCo; leave it out where an actuator
            model brings its own.
        floor: add a floor and a light.

    Returns:
        A specification that the caller owns and may change before compiling it.

    Raises:
        InputError: a batch of designs.
    """
    import mujoco

    tree = build_tree(design)
    spec = mujoco.MjSpec.from_string(description.urdf(design, tree))
    spec.modelname = design.name
    spec.option.timestep = TIME_STEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    base = spec.body(tree.base)
    if tree.floating:
        base.add_freejoint(name=BASE_JOINT)
    base.pos = [0.0, 0.0, float(zero_height(design))]
    _dress_geoms(spec, design, tree)
    for joint in tree.moving:
        hinge = spec.joint(joint.name)
        hinge.actfrclimited = mujoco.mjtLimited.mjLIMITED_FALSE
        hinge.damping = (
            [joint.viscous if friction else 0.0, 0.0, 0.0]
            if np.ndim(hinge.damping)
            else (joint.viscous if friction else 0.0)
        )
        hinge.frictionloss = joint.coulomb if friction else 0.0
        hinge.armature = 0.0
        hinge.solref_limit = [design.stop_section.time_constant, design.stop_section.damping_ratio]
        hinge.solimp_limit = [
            min(0.9, design.stop_section.impedance),
            design.stop_section.impedance,
            *STOP_IMPEDANCE_SHAPE,
        ]
    _add_springs(spec, design)
    _add_drives(spec, design)
    _add_sensors(spec, design, tree)
    if floor:
        spec.worldbody.add_geom(
            name=FLOOR,
            type=mujoco.mjtGeom.mjGEOM_PLANE,
            size=[0, 0, 1],
            contype=1,
            conaffinity=0,
            friction=_friction(design),
            solref=[design.contact_section.time_constant, design.contact_section.damping_ratio],
            rgba=[0.93, 0.93, 0.91, 1],
        )
        spec.worldbody.add_light(pos=[1, 1, 4], dir=[-0.2, -0.2, -1], castshadow=False)
    _add_stand(spec, tree)
    return spec


def mujoco_model(
    design: RobotDesign, *, friction: bool = True, floor: bool = True
) -> mujoco.MjModel:
    """Compiled MuJoCo model of one robot; see `mujoco_spec`.

    Args:
        design: one robot; batches are refused.
        friction: joint friction (Coulomb and viscous) by MuJoCo.
        floor: add a floor and a light.

    Returns:
        The compiled model.
    """
    return mujoco_spec(design, friction=friction, floor=floor).compile()


def mjcf(design: RobotDesign, *, friction: bool = True) -> str:
    """MJCF text of one robot, numbers in full precision.

    Args:
        design: one robot; batches are refused.
        friction: joint friction (Coulomb and viscous) by MuJoCo.

    Returns:
        The XML text, as `mujoco_spec` describes the robot, without a floor.
    """
    spec = mujoco_spec(design, friction=friction)
    with _full_precision():
        return str(spec.to_xml())


def _friction(design: RobotDesign) -> list[float]:
    return [design.contact_section.friction, design.contact_section.torsional_friction, 0.0001]


def _dress_geoms(spec: mujoco.MjSpec, design: RobotDesign, tree: Tree) -> None:
    import mujoco

    for link in tree.links:
        body = spec.body(link.name)
        colliding = 0
        for geom in body.geoms:
            geom.mass = 0.0
            geom.density = 0.0
            geom.conaffinity = 0
            is_pad = bool(geom.contype)
            geom.contype = 0
            geom.group = 2
            geom.rgba = [0.72, 0.74, 0.78, 1.0]
            if is_pad:
                geom.name = f"{link.name}_pad_{colliding}"
                geom.conaffinity = 1
                geom.condim = 4
                geom.group = 3
                geom.friction = _friction(design)
                geom.solref = [
                    design.contact_section.time_constant,
                    design.contact_section.damping_ratio,
                ]
                geom.rgba = [0.15, 0.15, 0.17, 1.0]
                colliding += 1
        if link.pads:
            places = np.array([p.position for p in link.pads])
            low, high = (
                places.min(0) - 1.5 * design.contact_section.pad_radius,
                places.max(0) + 1.5 * design.contact_section.pad_radius,
            )
            body.add_site(
                name=f"{link.name}_sole",
                type=mujoco.mjtGeom.mjGEOM_BOX,
                pos=(low + high) / 2,
                size=(high - low) / 2,
                group=5,
            )


def _add_drives(spec: mujoco.MjSpec, design: RobotDesign) -> None:
    import mujoco

    matrix = transmission.joint_from_motor(design)
    joints, names = transmission.joint_names(design), transmission.motor_names(design)
    constants, inertia = motor_arrays(design), rotor_inertia(design)
    for side in design.copies:
        for column, motor in enumerate(names):
            tendon = spec.add_tendon(name=prefixed(side, motor), armature=inertia[column])
            for row, joint in enumerate(joints):
                if matrix[row, column]:
                    tendon.wrap_joint(prefixed(side, joint), matrix[row, column])
            limit = constants.standstill_torque[column]
            spec.add_actuator(
                name=prefixed(side, motor),
                target=prefixed(side, motor),
                trntype=mujoco.mjtTrn.mjTRN_TENDON,
                ctrllimited=True,
                ctrlrange=[-limit, limit],
            )


def _add_springs(spec: mujoco.MjSpec, design: RobotDesign) -> None:
    """Springs of passive toes; their dampers are part of the joint's viscous friction."""
    if not isinstance(design, HyperLeg) or design.toe.joint != "passive":
        return
    for side in design.copies:
        joint = spec.joint(prefixed(side, "toe"))
        stiffness = float(design.toe.stiffness)
        joint.stiffness = [stiffness, 0.0, 0.0] if np.ndim(joint.stiffness) else stiffness
        joint.springref = float(np.deg2rad(design.joints.toe.default_deg))


def _add_sensors(spec: mujoco.MjSpec, design: RobotDesign, tree: Tree) -> None:
    import mujoco

    kind, place = mujoco.mjtSensor, mujoco.mjtObj
    spec.body(tree.base).add_site(name="imu", pos=[0.0, 0.0, 0.0], group=5)
    for name, sensor in (
        ("gyro", kind.mjSENS_GYRO),
        ("accelerometer", kind.mjSENS_ACCELEROMETER),
        ("velocimeter", kind.mjSENS_VELOCIMETER),
    ):
        spec.add_sensor(name=name, type=sensor, objtype=place.mjOBJ_SITE, objname="imu")
    spec.add_sensor(
        name="base_orientation", type=kind.mjSENS_FRAMEQUAT, objtype=place.mjOBJ_SITE, objname="imu"
    )
    for joint in tree.moving:
        spec.add_sensor(
            name=f"{joint.name}_position",
            type=kind.mjSENS_JOINTPOS,
            objtype=place.mjOBJ_JOINT,
            objname=joint.name,
        )
        spec.add_sensor(
            name=f"{joint.name}_velocity",
            type=kind.mjSENS_JOINTVEL,
            objtype=place.mjOBJ_JOINT,
            objname=joint.name,
        )
    for side in design.copies:
        for motor in transmission.motor_names(design):
            name = prefixed(side, motor)
            spec.add_sensor(
                name=f"{name}_motor_velocity",
                type=kind.mjSENS_TENDONVEL,
                objtype=place.mjOBJ_TENDON,
                objname=name,
            )
            spec.add_sensor(
                name=f"{name}_motor_torque",
                type=kind.mjSENS_ACTUATORFRC,
                objtype=place.mjOBJ_ACTUATOR,
                objname=name,
            )
    for link in tree.links:
        if link.pads:
            spec.add_sensor(
                name=f"{link.name}_load",
                type=kind.mjSENS_TOUCH,
                objtype=place.mjOBJ_SITE,
                objname=f"{link.name}_sole",
            )


def _add_stand(spec: mujoco.MjSpec, tree: Tree) -> None:
    """Keyframe of the default posture, its lowest pad on the floor."""
    import mujoco

    model = spec.compile()
    data = mujoco.MjData(model)
    for joint in tree.moving:
        data.joint(joint.name).qpos = joint.default
    mujoco.mj_kinematics(model, data)
    heights = [
        float(data.geom(i).xpos[2] - model.geom_size[i, 0])
        for i in range(model.ngeom)
        if model.geom_conaffinity[i] == 1
    ]
    if tree.floating and heights:
        data.qpos[2] -= min(heights)
    spec.add_key(name=STAND, qpos=data.qpos.copy())


@contextmanager
def _full_precision() -> Iterator[None]:
    """MuJoCo writes six digits; its library has a setting for more that the Python interface does
    not show.
    """
    import mujoco

    libraries = sorted(Path(mujoco.__file__).parent.glob("libmujoco*"))
    library: Any = ctypes.CDLL(str(libraries[0])) if libraries else None
    setter = getattr(library, "_mjPRIVATE__set_xml_precision", None)
    if setter is None:
        raise RuntimeError("this MuJoCo cannot write full precision; install the pinned version")
    setter.argtypes = [ctypes.c_int]
    setter(16)
    try:
        yield
    finally:
        setter(6)
