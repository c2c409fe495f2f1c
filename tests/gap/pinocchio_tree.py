"""Pinocchio models of the same trees, as oracles of rigid-body dynamics."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from hyperleg_design.gap.model.mechanism import BASE, Mechanism, mass_properties


def inertia(parameters: np.ndarray) -> pin.Inertia:
    """Of the ten inertial parameters of a body."""
    return pin.Inertia(*mass_properties(parameters))


def pinocchio_model(tree: Mechanism, gravity: np.ndarray) -> pin.Model:
    """Build a Pinocchio model of the same tree; `q` is measured from `reference`, and rotors are
    left out.

    Configurations are base position and quaternion (x y z w), where the base floats, then joints.
    Frames have the names of links.

    Args:
        tree: the robot.
        gravity: in the world [m/s^2], `(3,)`.

    Returns:
        The model.
    """
    model: Any = pin.Model()
    model.gravity.linear = np.asarray(gravity, float)
    root = 0
    if tree.floating:
        root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "floating_base")
        model.appendBodyToJoint(root, inertia(tree.base_inertial), pin.SE3.Identity())
    places: list[int] = []
    for index, name in enumerate(tree.joints):
        kind = pin.JointModelRZ() if tree.hinge[index] else pin.JointModelPZ()
        above = root if tree.parent[index] == BASE else places[tree.parent[index]]
        places.append(
            model.addJoint(above, kind, pin.SE3(tree.rotation[index], tree.offset[index]), name)
        )
        model.appendBodyToJoint(places[-1], inertia(tree.inertial[index]), pin.SE3.Identity())
    for index, name in enumerate(tree.links):
        carrier = int(tree.link_joint[index])
        place = pin.SE3(tree.link_rotation[index], tree.link_offset[index])
        model.addFrame(
            pin.Frame(name, root if carrier == BASE else places[carrier], place, pin.FrameType.BODY)
        )
    return model
