"""The MuJoCo model that is simulated: the robot's, without drawing shapes, with one contact sensor
a sole pad and one sensor of the stops' torque a joint, in this order.
"""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InputError, of_batch
from hyperleg_design.robot.mjcf import FLOOR, mujoco_spec
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.robot.parameters.values import leaves
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.simulation.alteration import Alteration, damps_motors, edited
from hyperleg_design.simulation.layout import Layout, layout_of
from hyperleg_design.simulation.settings import Physics

if TYPE_CHECKING:
    import mujoco

    from hyperleg_design.robot.parameters.described import RobotDesign

KEPT = 1024
"""Models that a process keeps with their layouts, some 0.1 MB each."""
_KEPT_ROBOTS: dict[str, tuple[mujoco.MjModel, Layout]] = {}
PAD_SENSOR_SIZE = 6
"""Numbers a pad: force and relative velocity in the contact's frame."""


def simulation_spec(design: RobotDesign, physics: Physics | None = None) -> mujoco.MjSpec:
    """Build the editable model of one robot as it is simulated; motors are on tendons, and joint
    friction is left to `actuation`.

    A state that is not finite stays as it is instead of being reset by MuJoCo, so that it can be
    reported. Controls are not clamped: `actuation` holds them inside the motors' envelopes.

    Args:
        design: one robot.
        physics: settings of the simulation; the defaults where left out.

    Returns:
        The specification.
    """
    import mujoco

    physics = physics or Physics()
    layout = layout_of(design)
    _check_walker(design, layout)
    spec = mujoco_spec(design, friction=False)
    for sensor in list(spec.sensors):
        spec.delete(sensor)
    for body in spec.bodies:
        for geom in list(body.geoms):
            if geom.name in layout.pads:
                geom.condim = int(physics.contact_dimensions)
            elif geom.name != FLOOR:
                spec.delete(geom)
    spec.geom(FLOOR).condim = int(physics.contact_dimensions)
    option = spec.option
    option.timestep = physics.time_step
    option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{physics.integrator.upper()}")
    option.cone = getattr(mujoco.mjtCone, f"mjCONE_{physics.cone.upper()}")
    option.iterations = int(physics.iterations)
    option.tolerance = physics.tolerance
    option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET) | int(
        mujoco.mjtDisableBit.mjDSBL_CLAMPCTRL
    )
    data = 1 << int(mujoco.mjtConDataField.mjCONDATA_FORCE) | 1 << int(
        mujoco.mjtConDataField.mjCONDATA_LINVEL
    )
    geom_kind, strongest, slots = mujoco.mjtObj.mjOBJ_GEOM, 2, 1
    for pad in layout.pads:
        # Floor first: the sensor's normal then points from the floor to the pad.
        spec.add_sensor(
            name=pad,
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=geom_kind,
            objname=FLOOR,
            reftype=geom_kind,
            refname=pad,
            intprm=[data, strongest, slots],
        )
    for joint in layout.joints:
        spec.add_sensor(
            name=f"{joint}_stop",
            type=mujoco.mjtSensor.mjSENS_JOINTLIMITFRC,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            objname=joint,
        )
    return spec


def _check_walker(design: RobotDesign, layout: Layout) -> None:
    """Whether a robot can be simulated: it has pads, stiffness at each joint, and moves freely.

    Raises:
        InputError: names what is missing.
    """
    where = design.source or design.name
    if isinstance(design, TreeDesign) and design.trunk.motion != "floating":
        remedy = "expects floating: what is simulated walks; a robot on a stand can be analysed"
        raise InputError(where, "trunk.motion", str(design.trunk.motion), remedy)
    if not layout.pads:
        remedy = "has no pads, so it stands on nothing; add pads to its feet"
        raise InputError(where, "pads", None, remedy)
    for name, joint in design.joint_sections.items():
        if not np.all(np.asarray(joint.stiffness) > 0):
            remedy = "must be positive in simulation: it is the joint controller's gain"
            raise InputError(where, f"joints.{name}.stiffness", 0.0, remedy)


def simulation_model(
    design: RobotDesign, physics: Physics | None = None, alterations: Sequence[Alteration] = ()
) -> mujoco.MjModel:
    """Compile `simulation_spec`, with the shapes and edits of alterations.

    Args:
        design: one robot.
        physics: settings of the simulation; the defaults where left out.
        alterations: of the simulation.

    Returns:
        The compiled model.
    """
    import mujoco

    spec = simulation_spec(design, physics)
    for alteration in alterations:
        alteration.shape(spec)
    model = edited(spec.compile(), alterations)
    if damps_motors(alterations):
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    # MuJoCo's solver stops where an improvement over `meaninertia` is below `tolerance`. A batch
    # can give each of its robots a tolerance of its own, but no mean inertia.
    model.opt.tolerance *= model.stat.meaninertia
    model.stat.meaninertia = 1.0
    return model


def simulated_robots(
    designs: Sequence[RobotDesign], physics: Physics | None = None
) -> list[tuple[mujoco.MjModel, Layout]]:
    """Compile the models and compute the layouts of several designs; equal designs share both.

    The latest `KEPT` are kept in this process, so that a design that is evaluated again is neither
    compiled nor measured again. Nobody may write into them.

    Args:
        designs: single robots.
        physics: settings of the simulation; the defaults where left out.

    Returns:
        `simulation_model` without alterations, and `layout_of`, of each design.

    Raises:
        InputError: the first reason why designs cannot be simulated; its `bad` marks them.
    """
    physics = physics or Physics()
    robots = []
    errors: dict[int, InputError] = {}
    for number, design in enumerate(designs):
        key = _fingerprint(design, physics)
        try:
            robot = _KEPT_ROBOTS.pop(key, None) or (
                simulation_model(design, physics),
                layout_of(design),
            )
        except InputError as error:
            errors[number] = error
            continue
        _KEPT_ROBOTS[key] = robot
        robots.append(robot)
        while len(_KEPT_ROBOTS) > KEPT:
            del _KEPT_ROBOTS[next(iter(_KEPT_ROBOTS))]
    if errors:
        raise of_batch(errors, len(designs))
    return robots


def _fingerprint(design: RobotDesign, physics: Physics) -> str:
    """All numbers and texts that decide a model and a layout."""
    arrays = motor_arrays(design)  # the catalogue's constants may change under the same name
    described = (leaves(design), vars(arrays), vars(physics))
    return hashlib.sha256(pickle.dumps(described)).hexdigest()


def pad_forces(sensors: np.ndarray) -> np.ndarray:
    """Compute the forces of the floor on the pads.

    On a floor the contact's frame is (z, y, -x) of the world.

    Args:
        sensors: values of the P contact sensors, `(..., 6 P)`.

    Returns:
        Forces in the world [N], `(..., P, 3)`.
    """
    raw = sensors.reshape(*sensors.shape[:-1], -1, PAD_SENSOR_SIZE)
    return np.stack([-raw[..., 2], raw[..., 1], raw[..., 0]], -1)


def pad_loads(sensors: np.ndarray) -> np.ndarray:
    """Compute the vertical forces of the floor on the pads.

    Args:
        sensors: values of the P contact sensors, `(..., 6 P)`.

    Returns:
        Forces [N], `(..., P)`.
    """
    return sensors[..., 0::PAD_SENSOR_SIZE].copy()


def pad_slip(sensors: np.ndarray) -> np.ndarray:
    """Compute the speed at which each touching pad slides over the floor.

    Args:
        sensors: values of the P contact sensors, `(..., 6 P)`.

    Returns:
        Speeds [m/s], `(..., P)`; zero where a pad does not touch.
    """
    return np.sqrt(sensors[..., 4::PAD_SENSOR_SIZE] ** 2 + sensors[..., 5::PAD_SENSOR_SIZE] ** 2)


def foot_loads(loads: np.ndarray, pads_of_foot: Sequence[int]) -> np.ndarray:
    """Sum the vertical forces on the pads of each foot.

    Args:
        loads: on the pads, foot after foot [N].
        pads_of_foot: number of pads of each foot, `(F,)`, as `Layout.pads_of_foot`.

    Returns:
        Forces on the feet [N], `(..., F)`.
    """
    shape = (*loads.shape[:-1], len(pads_of_foot), max(pads_of_foot))
    if np.prod(shape) == loads.size:
        by_foot = loads.reshape(shape)
    else:
        by_foot = np.zeros(shape)
        by_foot[..., np.arange(shape[-1]) < np.array(pads_of_foot)[:, None]] = loads
    # a sum of each row by itself: a matrix product's last digit depends on the number of rows
    return np.add.reduce(by_foot, -1)
