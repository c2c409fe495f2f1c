"""Rigid-body dynamics of one robot in Pinocchio, rotor inertia included, and how its states read in
MuJoCo.

Pinocchio's own armature is diagonal; coupled motors reflect a full matrix M diag(J) M^T, which is
added here. It does not depend on posture, because M is that of a printed posture, so it adds no
velocity-dependent term.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.robot import description, transmission
from hyperleg_design.robot.kinematics.dimensions import zero_height
from hyperleg_design.robot.kinematics.kinematic_tree import Tree
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.laws.gear import rotor_inertia
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.robot.trees.tree_limb import turned

if TYPE_CHECKING:
    import pinocchio

    from hyperleg_design.robot.parameters.described import RobotDesign

GRAVITY = 9.81
"""Gravitational acceleration [m/s^2], as Pinocchio and MuJoCo have it."""


@dataclass(frozen=True, eq=False)
class RigidBodyModel:
    """A floating (or fixed) robot in Pinocchio's coordinates.

    `q` is base position, base quaternion x y z w, then joints left leg first; `v` is base velocity
    in the base's own frame (linear, angular), then joint velocities. A fixed base has the joints
    only.
    """

    design: Any
    """A `RobotDesign` of any family."""
    tree: Tree
    model: pinocchio.Model
    data: pinocchio.Data
    floating: bool
    reflected: np.ndarray
    """Rotor inertia at the velocities, `(nv, nv)` [kg m^2]."""

    @property
    def base_dof(self) -> int:
        """Velocities of the base: 6, or 0 when fixed."""
        return 6 if self.floating else 0

    def mass_matrix(self, q: np.ndarray) -> np.ndarray:
        """Compute the joint-space inertia with rotors (CRBA).

        Args:
            q: configuration in Pinocchio's coordinates, `(nq,)`.

        Returns:
            The symmetric matrix, `(nv, nv)`.
        """
        import pinocchio as pin

        matrix = np.array(pin.crba(self.model, self.data, q))
        upper = np.triu(matrix)
        return upper + np.triu(matrix, 1).T + self.reflected

    def inverse_dynamics(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Compute the generalised forces of a motion with rotors, without contacts or friction
        (RNEA).

        Args:
            q: configuration, `(nq,)`.
            v: velocity, `(nv,)`.
            a: acceleration, `(nv,)`.

        Returns:
            The forces [N, Nm], `(nv,)`.
        """
        import pinocchio as pin

        return np.array(pin.rnea(self.model, self.data, q, v, a)) + self.reflected @ a

    def center_of_mass(self, q: np.ndarray) -> np.ndarray:
        """Compute the position of the centre of mass in the world.

        Args:
            q: configuration, `(nq,)`.

        Returns:
            `(3,)` [m].
        """
        import pinocchio as pin

        return np.array(pin.centerOfMass(self.model, self.data, q))

    def frame_position(self, q: np.ndarray, link: str) -> np.ndarray:
        """Compute the position of a link's origin in the world.

        Args:
            q: configuration, `(nq,)`.
            link: name of the link.

        Returns:
            `(3,)` [m].
        """
        import pinocchio as pin

        pin.framesForwardKinematics(self.model, self.data, q)
        return np.array(self.data.oMf[self.model.getFrameId(link)].translation)

    def frame_jacobian(self, q: np.ndarray, link: str) -> np.ndarray:
        """Compute the Jacobian of a link's origin in world axes.

        Args:
            q: configuration, `(nq,)`.
            link: name of the link.

        Returns:
            Linear, then angular velocity over `v`, `(6, nv)`.
        """
        import pinocchio as pin

        return np.array(
            pin.computeFrameJacobian(
                self.model, self.data, q, self.model.getFrameId(link), pin.LOCAL_WORLD_ALIGNED
            )
        )

    def neutral(self) -> np.ndarray:
        """Compute the zero posture, with the base at the height at which straight legs touch the
        floor.

        Returns:
            Configuration in Pinocchio's coordinates, `(nq,)`.
        """
        import pinocchio as pin

        q = np.array(pin.neutral(self.model))
        if self.floating:
            q[2] = float(zero_height(self.design))
        return q

    def to_mujoco(
        self, q: np.ndarray, v: np.ndarray | None = None, a: np.ndarray | None = None
    ) -> tuple[np.ndarray, ...]:
        """Convert a state to MuJoCo's coordinates: the quaternion begins with w, and the base's
        linear velocity and acceleration are in world axes.

        Args:
            q: configuration in Pinocchio's coordinates, `(nq,)`.
            v: velocity, `(nv,)`; may be left out.
            a: acceleration, `(nv,)`; may be left out, and needs `v`.

        Returns:
            `qpos`, and `qvel` and `qacc` where `v` and `a` are given.
        """
        state = [q.copy()]
        if self.floating:
            state[0][3:7] = q[[6, 3, 4, 5]]
        rotation = quaternion_matrix(q[3:7]) if self.floating else np.eye(3)
        if v is not None:
            state.append(v.copy())
            if self.floating:
                state[-1][:3] = rotation @ v[:3]
        if a is not None:
            assert v is not None
            state.append(a.copy())
            if self.floating:
                state[-1][:3] = rotation @ (a[:3] + np.cross(v[3:6], v[:3]))
        return tuple(state)


def quaternion_matrix(xyzw: np.ndarray) -> np.ndarray:
    """Convert a unit quaternion to a rotation matrix.

    Args:
        xyzw: the quaternion, with w last, `(4,)`.

    Returns:
        `(3, 3)`.
    """
    x, y, z, w = xyzw
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def leg_reflected_inertia(design: RobotDesign, posture: str | None = None) -> np.ndarray:
    """Compute the reflected inertia of one leg, M diag(J) M^T.

    Args:
        design: a robot or batch.
        posture: `walking` or `standing`; the design's own by default.

    Returns:
        `(..., joints, joints)` [kg m^2].
    """
    rotors = rotor_inertia(design)[..., : len(transmission.motor_names(design))]
    return transmission.reflected_inertia(transmission.joint_from_motor(design, posture), rotors)


def rigid_body_model(design: RobotDesign, *, floating: bool = True) -> RigidBodyModel:
    """Pinocchio model of one robot.

    Args:
        design: one robot; batches are refused.
        floating: whether the base moves freely; else it is welded to the world, as is one that its
            design fixes.

    Returns:
        The model with its data and the reflected inertias of the motors.

    Raises:
        InputError: a batch of designs.
    """
    import pinocchio as pin

    tree = build_tree(design)
    floating = floating and tree.floating
    model: Any
    if isinstance(design, TreeDesign):
        model = _model_of(tree, floating)
    else:
        text = description.urdf(design, tree)
        model = (
            pin.buildModelFromXML(text, pin.JointModelFreeFlyer())
            if floating
            else pin.buildModelFromXML(text)
        )
    names = [j.name for j in tree.moving]
    own = list(model.names)[2:] if floating else list(model.names)[1:]
    if own != names:
        raise RuntimeError(f"joint order of Pinocchio, {own}, is not the tree's, {names}")
    base = 6 if floating else 0
    reflected = np.zeros((model.nv, model.nv))
    block = leg_reflected_inertia(design)
    count = block.shape[0]
    for leg in range(len(design.copies)):
        place = slice(base + leg * count, base + (leg + 1) * count)
        reflected[place, place] = block
    return RigidBodyModel(design, tree, model, model.createData(), floating, reflected)


def _model_of(tree: Tree, floating: bool) -> Any:
    """Pinocchio's model with the joints in the tree's order, which a URDF does not keep."""
    import pinocchio as pin

    model = pin.Model()
    model.name = tree.name
    start = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.0 if floating else tree.height]))
    place: dict[str, tuple[int, Any]] = {tree.base: (0, start)}
    if floating:
        root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
        place[tree.base] = (root, pin.SE3.Identity())
    for joint in tree.joints:
        parent, at = place[joint.parent]
        own = at * pin.SE3(turned(np.rad2deg(joint.turn)), np.array(joint.position))
        if joint.fixed:
            place[joint.child] = (parent, own)
            continue
        kind = pin.JointModelRevoluteUnaligned(np.array(joint.axis))
        place[joint.child] = (
            model.addJoint(parent, kind, own, joint.name),
            pin.SE3.Identity(),
        )
    for link in tree.links:
        index, at = place[link.name]
        model.appendBodyToJoint(index, pin.Inertia(link.mass, link.com, link.inertia), at)
        model.addBodyFrame(link.name, index, at, 0)
    return model
