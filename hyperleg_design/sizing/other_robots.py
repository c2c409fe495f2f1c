"""Other legged robots, from the descriptions in `example-robot-data`, measured as HyperLeg is: how
heavy, where, how far to swing.

Posture: as the description has it at zero, then the knee turned until, seen along its axis, hip,
knee and ankle (the foot where there is no ankle) lie on a straight line. A leg that is closed by
rods (Cassie) stays as its description poses it, nearly stretched. Some robots cannot reach that
posture; it serves comparison only. Leg length runs, across the hip-pitch axis, from it to a point
of the sole under the ankle, or to the far side of a round foot. Rods that a description hangs below
the knee count there.

Left out, of what the package has: `hector` is a quadrotor, `alex` an upper body; `simple_humanoid`
has invented masses (130.8 kg) and an inertia of 1 kg m^2 for every link; `centauro` has wheels;
`quadruped` and `solo` (8 joints) are older builds of `solo12`.
"""

from __future__ import annotations

import importlib.metadata
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.sizing.inertia import LegInertia
from hyperleg_design.sizing.robot_sources import SOURCES, RobotSource

PACKAGE = "example-robot-data"


@dataclass(frozen=True, eq=False)
class Body:
    """What moves with one joint of a description, in the world, in the description's zero
    posture.
    """

    joint: str
    parent: str
    """Joint it hangs from; empty on the trunk."""
    origin: np.ndarray
    """Position of the joint [m], `(3,)`."""
    axis: np.ndarray
    """Unit vector, `(3,)`; zero where the joint has no single axis."""
    mass: float
    """Mass [kg]."""
    com: np.ndarray
    """Centre of mass [m], `(3,)`."""
    inertia: np.ndarray
    """Inertia about `com` in the axes of the world [kg m^2], `(3, 3)`."""


@dataclass(frozen=True, eq=False)
class Description:
    """A robot as its description poses it."""

    bodies: Mapping[str, Body]
    """Bodies by the joint that carries them; the trunk stands under the empty name."""
    foot_position: np.ndarray
    """Origin of the foot's frame [m], `(3,)`."""
    foot_rotation: np.ndarray
    """Rotation of the foot, `(3, 3)`."""
    foot_joint: str
    """Joint that the foot moves with."""

    def behind(self, joint: str) -> list[Body]:
        """List the bodies that move with a joint.

        Args:
            joint: name of the joint.

        Returns:
            The bodies, parents first.
        """
        bodies = [self.bodies[joint]]
        for body in bodies:
            bodies += [
                child
                for child in self.bodies.values()
                if child.parent == body.joint and child.joint
            ]
        return bodies


@dataclass(frozen=True, eq=False)
class OtherRobot:
    """Measures of one published robot, for comparison."""

    source: RobotSource
    leg: LegInertia
    """Each a number; the total mass is nan where the description is not whole."""
    knee_turned: float
    """Angle by which the knee was turned from the description's zero to make the leg straight
    [rad]; NaN where it was left as it is."""


def robots_folder() -> Path:
    """Find the folder of the robots of `example-robot-data`, wherever it is installed.

    Returns:
        Its path.

    Raises:
        InputError: the package is not installed, or without its robots.
    """
    try:
        files = importlib.metadata.files(PACKAGE) or []
    except importlib.metadata.PackageNotFoundError:
        files = []
    # .../example-robot-data/robots/ROBOT/FILE of a wheel; the prefix of an environment that is not
    # pip's
    folders = [
        Path(str(f.locate())).parents[1] for f in files if f.parts[-4:-2] == (PACKAGE, "robots")
    ][:1]
    for folder in (*folders, Path(sys.prefix) / "share" / PACKAGE / "robots"):
        if folder.is_dir():
            return folder.resolve()
    raise InputError(
        PACKAGE,
        "",
        None,
        "is not installed, so there are no robots to compare with; run pip install "
        "example-robot-data",
    )


def find_source(name: str) -> RobotSource:
    """Look up a robot of `SOURCES` by name, whatever the case.

    Args:
        name: of the robot.

    Returns:
        The robot's source.

    Raises:
        InputError: there is none.
    """
    for source in SOURCES:
        if source.name.lower() == name.lower():
            return source
    raise InputError("robot", "", name, f"expects one of {', '.join(s.name for s in SOURCES)}")


@cache
def measure(source: RobotSource) -> OtherRobot:
    """Measure the mass and inertia of one leg of a robot.

    Args:
        source: names the description and the joints.

    Returns:
        The measures.

    Raises:
        InputError: the description is missing or does not have the joints named.
    """
    path = robots_folder() / source.file
    if not path.is_file():
        raise InputError(
            PACKAGE,
            source.name,
            str(path),
            "no such file; this release of the package does not have the robot",
        )
    description = _read_sdf(path, source) if path.suffix == ".sdf" else _read_urdf(path, source)
    hip, knee = description.bodies[source.hip_pitch], description.bodies[source.knee]
    sole = description.foot_position + description.foot_rotation @ np.array(source.sole)
    turned, turn = float("nan"), np.eye(3)
    if path.suffix != ".sdf":  # rods would have to follow
        end = description.bodies[source.ankle].origin if source.ankle else sole
        turned = _straightening(hip.origin, knee.origin, end, knee.axis)
        turn = _rotation(knee.axis, turned)
    distal = description.behind(source.knee)
    lower = {body.joint for body in distal}
    if description.foot_joint in lower:
        sole = knee.origin + turn @ (sole - knee.origin)
    inertia, moment, swing_mass = np.zeros((3, 3)), np.zeros(3), 0.0
    for body in description.behind(source.hip_pitch):
        centre, own = body.com, body.inertia
        if body.joint in lower:
            centre, own = knee.origin + turn @ (centre - knee.origin), turn @ own @ turn.T
        offset = centre - hip.origin
        inertia += own + body.mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
        moment += body.mass * offset
        swing_mass += body.mass
    total = sum(body.mass for body in description.bodies.values())
    leg = LegInertia(
        total_mass=total if source.whole else float("nan"),
        leg_mass=sum(body.mass for body in description.behind(source.first_hip)),
        distal_mass=sum(body.mass for body in distal),
        leg_length=float(np.linalg.norm(_across(sole - hip.origin, hip.axis))) + source.foot_radius,
        swing_mass=swing_mass,
        swing_inertia=float(hip.axis @ inertia @ hip.axis),
        com_distance=float(np.linalg.norm(_across(moment / swing_mass, hip.axis))),
    )
    return OtherRobot(source, leg, turned)


def compare(names: Iterable[str] | None = None) -> tuple[OtherRobot, ...]:
    """Measure several robots of `SOURCES`.

    Args:
        names: of robots of `SOURCES`; all by default.

    Returns:
        The measures, in this order.

    Raises:
        InputError: no such robot, or `example-robot-data` is not there.
    """
    chosen = SOURCES if names is None else tuple(find_source(name) for name in names)
    return tuple(measure(source) for source in chosen)


def _across(vector: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """Part of a vector that is perpendicular to an axis."""
    return vector - (vector @ axis) * axis


def _straightening(hip: np.ndarray, knee: np.ndarray, end: np.ndarray, axis: np.ndarray) -> float:
    """Angle about the knee's axis that brings the end of the leg into the line from hip to knee
    [rad].
    """
    upper, lower = _across(knee - hip, axis), _across(end - knee, axis)
    return float(np.arctan2(axis @ np.cross(lower, upper), lower @ upper))


def _rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotation about a unit vector (Rodrigues), `(3, 3)`."""
    x, y, z = axis
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew


def _read_urdf(path: Path, source: RobotSource) -> Description:
    """Read a URDF through Pinocchio, which merges links that are fixed to each other."""
    import pinocchio as pin

    model: Any = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    pin.computeJointJacobians(model, data, pin.neutral(model))
    bodies = {}
    for index in range(1, model.njoints):
        placed, own = data.oMi[index], model.inertias[index]
        column = pin.getJointJacobian(model, data, index, pin.LOCAL_WORLD_ALIGNED)[
            3:, model.idx_vs[index]
        ]
        trunk = index == 1
        name = "" if trunk else str(model.names[index])
        rotation = np.array(placed.rotation)
        parent = int(model.parents[index])
        bodies[name] = Body(
            joint=name,
            parent="" if parent <= 1 else str(model.names[parent]),
            origin=np.array(placed.translation),
            axis=np.zeros(3) if trunk else np.array(column),
            mass=float(own.mass),
            com=np.array(placed.act(own.lever)),
            inertia=rotation @ np.array(own.inertia) @ rotation.T,
        )
    _require(path, source, bodies, [str(frame.name) for frame in model.frames])
    frame = model.getFrameId(source.foot)
    placed = data.oMf[frame]
    joint = str(model.names[model.frames[frame].parentJoint])
    return Description(bodies, np.array(placed.translation), np.array(placed.rotation), joint)


def _read_sdf(path: Path, source: RobotSource) -> Description:
    """Read links of an SDF model as posed in it; of a link that closes a loop, the first joint
    counts.
    """
    from xml.etree import ElementTree

    root = ElementTree.parse(path).getroot().find("model")
    links = {
        str(link.get("name")): link for link in (root.findall("link") if root is not None else ())
    }
    joints = {
        str(j.findtext("child")).strip(): j
        for j in reversed(root.findall("joint") if root is not None else ())
    }
    bodies, frames = {}, {}
    for name, link in links.items():
        position, rotation = _pose(link.findtext("pose"))
        frames[name] = position, rotation
        com, turn = _pose(link.findtext("inertial/pose"))
        joint = joints.get(name)
        axis = np.zeros(3)
        own = "" if joint is None else str(joint.get("name"))
        if joint is not None and (text := joint.findtext("axis/xyz")):
            axis = np.array([float(v) for v in text.split()])
            if joint.findtext("axis/use_parent_model_frame", "0").strip() not in ("1", "true"):
                axis = rotation @ axis
            axis = axis / np.linalg.norm(axis)
        up = "" if joint is None else str(joint.findtext("parent")).strip()
        bodies[own] = Body(
            joint=own,
            parent=str(joints[up].get("name")) if up in joints else "",
            origin=position,
            axis=axis,
            mass=float(link.findtext("inertial/mass", "0")),
            com=position + rotation @ com,
            inertia=rotation @ turn @ _sdf_inertia(link) @ turn.T @ rotation.T,
        )
    _require(path, source, bodies, list(frames))
    return Description(bodies, *frames[source.foot], str(joints[source.foot].get("name")))


def _pose(text: str | None) -> tuple[np.ndarray, np.ndarray]:
    """Position and rotation of `x y z roll pitch yaw`."""
    x, y, z, roll, pitch, yaw = (float(v) for v in (text or "0 0 0 0 0 0").split())
    eye = np.eye(3)
    return np.array([x, y, z]), _rotation(eye[2], yaw) @ _rotation(eye[1], pitch) @ _rotation(
        eye[0], roll
    )


def _sdf_inertia(link: Any) -> np.ndarray:
    xx, xy, xz, yy, yz, zz = (
        float(link.findtext(f"inertial/inertia/i{part}", "0"))
        for part in ("xx", "xy", "xz", "yy", "yz", "zz")
    )
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _require(
    path: Path, source: RobotSource, bodies: Mapping[str, Body], frames: list[str]
) -> None:
    """Whether a description has what the table names."""
    for field in ("first_hip", "hip_pitch", "knee", "ankle"):
        name = getattr(source, field)
        if (name or field != "ankle") and name not in bodies:
            raise InputError(
                path.name,
                f"{source.name}.{field}",
                name,
                "no such joint in this description; another release of example-robot-data?",
            )
    if source.foot not in frames:
        raise InputError(
            path.name,
            f"{source.name}.foot",
            source.foot,
            "no such link in this description; another release of example-robot-data?",
        )
