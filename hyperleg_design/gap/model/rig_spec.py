"""A subject whose base is fixed as an `MjSpec` with position servos, for tools that want MuJoCo's
own actuators.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hyperleg_design.gap.model.assembling import add_rotors
from hyperleg_design.gap.model.mechanism import mass_properties
from hyperleg_design.gap.model.subject import Subject

SENSOR = "position_"
"""Before the joint's name in that of its position sensor."""
LIGHTEST = 1e-9
"""Mass and inertia of frames that carry none of their own [kg, kg m^2], which MuJoCo refuses."""


def rig_spec(subject: Subject, step: float) -> Any:
    """Build a MuJoCo specification with links, rotors, nominal friction, and a position servo and
    sensor for each driven joint.

    Args:
        subject: with its base fixed and all gains known.
        step: of the simulation [s].

    Returns:
        The specification.
    """
    import mujoco

    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    spec.compiler.boundmass = LIGHTEST
    spec.compiler.boundinertia = LIGHTEST
    spec.option.timestep = step
    spec.option.gravity = subject.gravity
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    tree = subject.tree
    bodies: list[Any] = []
    armature = np.diag(subject.armature) if subject.one_to_one else np.zeros(tree.count)
    for i, name in enumerate(tree.joints):
        above = spec.worldbody if tree.parent[i] < 0 else bodies[int(tree.parent[i])]
        body = above.add_body(
            name=f"link_{name}", pos=tree.offset[i], quat=_quaternion(tree.rotation[i])
        )
        mass, com, inertia = mass_properties(tree.inertial[i])
        body.explicitinertial = True
        body.mass = max(mass, LIGHTEST)
        body.ipos = com
        body.fullinertia = [*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2]]
        kind = mujoco.mjtJoint.mjJNT_HINGE if tree.hinge[i] else mujoco.mjtJoint.mjJNT_SLIDE
        limited = bool(
            np.isfinite(subject.position_low[i]) and np.isfinite(subject.position_high[i])
        )
        limits = [subject.position_low[i], subject.position_high[i]] if limited else [0.0, 0.0]
        body.add_joint(
            name=name,
            type=kind,
            axis=[0, 0, 1],
            ref=float(tree.reference[i]),
            armature=float(armature[i]),
            limited=limited,
            range=limits,
            frictionloss=float(subject.coulomb[i]),
            damping=[float(subject.viscous[i]), 0, 0],
            stiffness=[float(subject.spring[i]), 0, 0],
            springref=float(subject.spring_rest[i]),
        )
        bodies.append(body)
        spec.add_sensor(
            name=SENSOR + name,
            type=mujoco.mjtSensor.mjSENS_JOINTPOS,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            objname=name,
        )
    if not subject.one_to_one:
        matrix, rotors = subject.joint_from_motor, subject.rotor_inertia
        add_rotors(spec, subject.joints, subject.motors, matrix, rotors)
    for i, name in enumerate(subject.joints):
        if subject.passive[i]:
            continue
        stiffness, damping = (float(v) for v in subject.gains[i])
        servo = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        servo.gaintype, servo.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
        servo.gainprm[0], servo.biasprm[1], servo.biasprm[2] = stiffness, -stiffness, -damping
        if subject.one_to_one and np.isfinite(subject.torque_limit[i]):
            servo.forcelimited = True
            servo.forcerange = [-float(subject.torque_limit[i]), float(subject.torque_limit[i])]
    return spec


def _quaternion(rotation: np.ndarray) -> np.ndarray:
    import mujoco

    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(rotation).ravel())
    return quaternion
