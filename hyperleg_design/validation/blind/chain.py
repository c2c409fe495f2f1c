"""Robots that the rigs hold: a tree of hinges in Pinocchio, its motors and what its data sheet says
of them.

Masses and frames are read from the compiled MJCF, which is the robot's published description; the
dynamics are Pinocchio's.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.validation.blind.arm import ARM_MJCF, SERVO_MJCF

if TYPE_CHECKING:
    import pinocchio

ROBOTS = ("hyperleg", "leg", "arm", "servo")
"""Names that `chain` knows; `leg` is the left one of `hyperleg`."""

ROBOT_FILE = "robot.xml"
"""Name of the MJCF that lies beside the logs of a robot that is no design."""
RIG_POSTURE = {
    "hip_yaw": -0.1,
    "hip_roll": 0.3,
    "hip_pitch": -0.3,
    "knee": 0.9,
    "ankle_pitch": 0.0,
    "ankle_roll": 0.0,
    "toe": -0.35,
}
"""Middle of the motions of a leg in the air [rad]: away from every limit."""
GRAVITY = np.array([0.0, 0.0, -9.81])


@dataclass(frozen=True, eq=False)
class Link:
    """A moving body with its joint."""

    name: str
    joint: str
    parent: int
    """Index of the moving body that carries it; -1 for the fixed base."""
    rotation: np.ndarray
    """Parent from joint frame `(3, 3)`."""
    place: np.ndarray
    """Of the joint frame in the parent's `(3,)` [m]."""
    axis: np.ndarray
    """In the joint frame `(3,)`."""
    mass: float
    """[kg]"""
    com: np.ndarray
    """In the joint frame `(3,)` [m]."""
    inertia: np.ndarray
    """About the centre of mass, axes of the joint frame `(3, 3)` [kg m^2]."""


@dataclass(frozen=True, eq=False)
class Chain:
    """A fixed-base robot with `n` joints and `m` motors, all values nominal."""

    name: str
    links: tuple[Link, ...]
    motors: tuple[str, ...]
    joint_from_motor: np.ndarray
    """M `(n, m)`: joint torque over motor torque; motor velocity is M^T joint velocity."""
    rotor_inertia: np.ndarray
    """At the motors `(m,)` [kg m^2]."""
    coulomb: np.ndarray
    """At the joints `(n,)` [Nm]."""
    viscous: np.ndarray
    """At the joints `(n,)` [Nms/rad]."""
    stiffness: np.ndarray
    """Gain of the joint controller `(n,)` [Nm/rad]."""
    damping: np.ndarray
    """Gain of the joint controller `(n,)` [Nms/rad]."""
    peak_torque: np.ndarray
    """Of the motors `(m,)` [Nm]."""
    stall_torque: np.ndarray
    """Of the motors at the nominal voltage, extrapolated `(m,)` [Nm]."""
    no_load_speed: np.ndarray
    """Of the motors at the nominal voltage `(m,)` [rad/s]."""
    torque_constant: np.ndarray
    """Of the motors `(m,)` [Nm/A]."""
    low: np.ndarray
    high: np.ndarray
    """Limits of the joints `(n,)` [rad]."""
    rest: np.ndarray
    """Middle posture that motions start from `(n,)` [rad]."""
    voltage: float
    """Nominal supply [V]."""
    mjcf: str | None
    """Text of its MJCF, where that is how a user would name it; None for a design."""
    robot: str
    """Name or file under which logs and the diagnosis know it."""

    @property
    def joints(self) -> tuple[str, ...]:
        """Names in order."""
        return tuple(link.joint for link in self.links)

    @property
    def diagonal(self) -> bool:
        """Whether motors and joints are one to one."""
        n, m = self.joint_from_motor.shape
        return n == m and not np.any(
            self.joint_from_motor - np.diag(np.diag(self.joint_from_motor))
        )

    def depth_mass(self) -> np.ndarray:
        """Mass that each joint carries `(n,)` [kg]."""
        carried = np.array([link.mass for link in self.links])
        for index in range(len(self.links) - 1, -1, -1):
            if self.links[index].parent >= 0:
                carried[self.links[index].parent] += carried[index]
        return carried

    def with_link(self, name: str, **values: Any) -> Chain:
        """Copy with other values of one link.

        Args:
            name: of the link.
            values: of the link's fields.

        Returns:
            The copy.
        """
        return replace(
            self,
            links=tuple(
                replace(link, **values) if link.name == name else link for link in self.links
            ),
        )

    def with_point_mass(self, name: str, mass: float, com: np.ndarray) -> Chain:
        """Copy with a point mass [kg] fixed to a link at `com` of its joint frame [m].

        Args:
            name: of the link.
            mass: [kg].
            com: in the joint's frame `(3,)` [m].

        Returns:
            The copy.
        """
        link = next(link for link in self.links if link.name == name)
        total = link.mass + mass
        middle = (link.mass * link.com + mass * np.asarray(com)) / total
        inertia = (
            link.inertia
            + steiner(link.mass, link.com - middle)
            + steiner(mass, np.asarray(com) - middle)
        )
        return self.with_link(name, mass=total, com=middle, inertia=inertia)

    def pinocchio(self, gravity: np.ndarray = GRAVITY) -> pinocchio.Model:
        """Its rigid bodies, without rotors.

        Args:
            gravity: `(3,)` [m/s^2].

        Returns:
            The model.
        """
        import pinocchio as pin

        model: Any = pin.Model()
        model.name = self.name
        ids: list[int] = []
        for link in self.links:
            parent = ids[link.parent] if link.parent >= 0 else 0
            ids.append(
                model.addJoint(
                    parent,
                    pin.JointModelRevoluteUnaligned(link.axis),
                    pin.SE3(link.rotation, link.place),
                    link.joint,
                )
            )
            model.appendBodyToJoint(
                ids[-1], pin.Inertia(link.mass, link.com, link.inertia), pin.SE3.Identity()
            )
        model.gravity.linear = np.asarray(gravity, float)
        return model


def steiner(mass: float, offset: np.ndarray) -> np.ndarray:
    """Inertia of a point mass about a point `offset` away `(3, 3)` [kg m^2].

    Args:
        mass: [kg].
        offset: `(3,)` [m].

    Returns:
        The inertia `(3, 3)` [kg m^2].
    """
    return mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))


@cache
def chain(name: str) -> Chain:
    """A robot of `ROBOTS`.

    Args:
        name: of the robot.

    Returns:
        The robot.

    Raises:
        ValueError: no such robot.
    """
    if name == "hyperleg":
        return _design(name)
    if name == "leg":
        return _half(_design("hyperleg"))
    if name == "arm":
        return _arm()
    if name == "servo":
        return _servo()
    raise ValueError(f"no robot {name!r}; there are {', '.join(ROBOTS)}")


def _design(name: str) -> Chain:
    from hyperleg_design.robot import transmission
    from hyperleg_design.robot.design import load_design
    from hyperleg_design.robot.mjcf import mujoco_spec
    from hyperleg_design.robot.motors import motor_arrays
    from hyperleg_design.robot.names import SIDES

    design = load_design(name)
    model = mujoco_spec(design, floor=False).compile()
    links = tree_links(model)
    matrix = transmission.joint_from_motor(design)
    rows, columns = matrix.shape
    constants, names = motor_arrays(design), transmission.motor_names(design)
    order = [f"{side}_{joint}" for side in SIDES for joint in transmission.joint_names(design)]
    if [link.joint for link in links] != order:
        raise RuntimeError("the design's joints come in another order than its legs")
    both = np.zeros((2 * rows, 2 * columns))
    both[:rows, :columns] = both[rows:, columns:] = matrix
    of_joints = [getattr(design.joints, joint) for joint in transmission.joint_names(design)]

    def twice(values: Any) -> np.ndarray:
        return np.tile(np.asarray(values, float)[:columns], 2)

    return Chain(
        name=name,
        links=links,
        motors=tuple(f"{side}_{motor}" for side in SIDES for motor in names),
        joint_from_motor=both,
        rotor_inertia=twice(constants.rotor_inertia),
        coulomb=np.tile([j.coulomb for j in of_joints], 2),
        viscous=np.tile([j.viscous for j in of_joints], 2),
        stiffness=np.tile([j.stiffness for j in of_joints], 2),
        damping=np.tile([j.damping for j in of_joints], 2),
        peak_torque=twice(constants.peak_torque),
        stall_torque=twice(constants.stall_torque),
        no_load_speed=twice(constants.no_load_speed),
        # No data sheet of the design's motors is at hand for this: a winding of 48 V at its no-load
        # speed (assumed).
        torque_constant=twice(48.0 / constants.no_load_speed),
        low=np.tile(np.radians([j.lower_deg for j in of_joints]), 2),
        high=np.tile(np.radians([j.upper_deg for j in of_joints]), 2),
        rest=np.tile([RIG_POSTURE[joint] for joint in transmission.joint_names(design)], 2),
        voltage=48.0,
        mjcf=None,
        robot=name,
    )


def _half(both: Chain) -> Chain:
    n, m = (size // 2 for size in both.joint_from_motor.shape)
    cut = {field.name: getattr(both, field.name) for field in fields(both)}
    halves: dict[str, Any] = {
        key: value[: (m if value.size == 2 * m and key in _OF_MOTORS else n)]
        for key, value in cut.items()
        if isinstance(value, np.ndarray) and value.ndim == 1
    }
    return replace(
        both,
        links=both.links[:n],
        motors=both.motors[:m],
        joint_from_motor=both.joint_from_motor[:n, :m],
        **halves,
    )


_OF_MOTORS = ("rotor_inertia", "peak_torque", "stall_torque", "no_load_speed", "torque_constant")


def _arm() -> Chain:
    import mujoco

    model = mujoco.MjModel.from_xml_string(ARM_MJCF)
    gear = model.actuator_gear[:, 0]
    peak = model.actuator_ctrlrange[:, 1] * gear
    # Drive modules speak of their output: torque, speed and inertia behind the gear, amperes of the
    # motor.
    return Chain(
        name="arm",
        links=tree_links(model),
        motors=tuple(model.actuator(i).name for i in range(model.nu)),
        joint_from_motor=np.eye(model.nu),
        rotor_inertia=model.dof_armature.copy(),
        coulomb=model.dof_frictionloss.copy(),
        viscous=model.dof_damping.copy(),
        stiffness=np.array([900.0, 1200.0, 400.0, 500.0, 90.0, 90.0, 60.0]),
        damping=np.array([40.0, 50.0, 14.0, 16.0, 2.5, 2.5, 1.8]),
        peak_torque=peak,
        stall_torque=3.0 * peak,
        no_load_speed=np.array([9.0, 9.0, 9.0, 9.0, 13.0, 13.0, 13.0]),
        torque_constant=np.array([0.11, 0.11, 0.10, 0.10, 0.06, 0.06, 0.06]) * gear,
        low=model.jnt_range[:, 0].copy(),
        high=model.jnt_range[:, 1].copy(),
        rest=np.array([0.1, -0.5, 0.2, 0.7, 0.1, 0.4, 0.0]),
        voltage=48.0,
        mjcf=ARM_MJCF,
        robot=ROBOT_FILE,
    )


def _servo() -> Chain:
    import mujoco

    model = mujoco.MjModel.from_xml_string(SERVO_MJCF)
    return Chain(
        name="servo",
        links=tree_links(model),
        motors=("swing",),
        joint_from_motor=np.eye(1),
        rotor_inertia=model.dof_armature.copy(),
        coulomb=model.dof_frictionloss.copy(),
        viscous=model.dof_damping.copy(),
        stiffness=np.array([6.0]),
        damping=np.array([0.15]),
        peak_torque=np.array([2.4]),
        stall_torque=np.array([2.8]),
        no_load_speed=np.array([14.0]),
        torque_constant=np.array([1.1]),
        low=model.jnt_range[:, 0].copy(),
        high=model.jnt_range[:, 1].copy(),
        rest=np.array([0.2]),
        voltage=12.0,
        mjcf=SERVO_MJCF,
        robot=ROBOT_FILE,
    )


def tree_links(model: Any) -> tuple[Link, ...]:
    """The hinges of a compiled MuJoCo model and the bodies on them; bodies without a joint go to
    the one that carries them.

    A free joint is left out: its body is the fixed base.

    Args:
        model: the compiled model.

    Returns:
        The links.

    Raises:
        ValueError: a joint that is neither hinge nor free, or several on one body.
    """
    import mujoco

    links: list[Link] = []
    home: dict[int, tuple[int, np.ndarray, np.ndarray]] = {
        0: (-1, np.eye(3), np.zeros(3))
    }  # link, its frame's rotation and place of the body
    for body in range(1, model.nbody):
        index, rotation, place = home[int(model.body_parentid[body])]
        turned = rotation @ matrix(model.body_quat[body])
        moved = place + rotation @ model.body_pos[body]
        joints = [j for j in range(model.njnt) if model.jnt_bodyid[j] == body]
        kinds = {int(model.jnt_type[j]) for j in joints}
        com, axes = model.body_ipos[body].copy(), matrix(model.body_iquat[body])
        inertia = axes @ np.diag(model.body_inertia[body]) @ axes.T
        if kinds == {int(mujoco.mjtJoint.mjJNT_FREE)}:
            home[body] = (-1, np.eye(3), np.zeros(3))
        elif not joints:
            home[body] = (index, turned, moved)
            if index >= 0 and model.body_mass[body] > 0:
                links[index] = _joined(
                    links[index],
                    float(model.body_mass[body]),
                    moved + turned @ com,
                    turned @ inertia @ turned.T,
                )
        elif len(joints) == 1 and kinds == {int(mujoco.mjtJoint.mjJNT_HINGE)}:
            anchor = model.jnt_pos[joints[0]]
            home[body] = (len(links), np.eye(3), -anchor)
            links.append(
                Link(
                    model.body(body).name,
                    model.joint(joints[0]).name,
                    index,
                    turned,
                    moved + turned @ anchor,
                    model.jnt_axis[joints[0]].copy(),
                    float(model.body_mass[body]),
                    com - anchor,
                    inertia,
                )
            )
        else:
            raise ValueError(f"body {model.body(body).name}: one hinge a body is what this reads")
    return tuple(links)


def _joined(link: Link, mass: float, com: np.ndarray, inertia: np.ndarray) -> Link:
    total = link.mass + mass
    middle = (link.mass * link.com + mass * com) / total
    return replace(
        link,
        mass=total,
        com=middle,
        inertia=link.inertia
        + inertia
        + steiner(link.mass, link.com - middle)
        + steiner(mass, com - middle),
    )


def matrix(quaternion: np.ndarray) -> np.ndarray:
    """Rotation of a unit quaternion w x y z, `(3, 3)`.

    Args:
        quaternion: `(4,)`.

    Returns:
        The rotation `(3, 3)`.
    """
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
