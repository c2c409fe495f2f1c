"""Named postures of a robot, in which its largest contact forces are asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.models import RigidBodyModel, rigid_body_model
from hyperleg_design.robot.names import SIDES
from hyperleg_design.robot.transmission import joint_names
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.sizing.contacts import TIP, contact_points
from hyperleg_design.sizing.kinematics import (
    about_y,
    check_range,
    has_toe_joint,
    hip_center,
    leg_angles,
    leg_reach,
)
from hyperleg_design.sizing.motions.foot_path import rolling

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.parameters.described import RobotDesign

POSTURES = ("standing", "mid_squat", "toe_off")
"""Named postures of `posture`."""
_KNEE = {"standing": np.deg2rad(20.0), "mid_squat": np.deg2rad(80.0), "toe_off": np.deg2rad(25.0)}
"""Knee flexion of the named postures (assumed)."""
_AHEAD = {"standing": 0.04, "mid_squat": 0.04, "toe_off": 0.20}
"""Hip ahead of the ankle's place when the foot is flat [m] (assumed)."""
_HEEL_PITCH = np.deg2rad(30.0)
"""Pitch of the foot at toe-off (assumed: late stance of human walking)."""


def posture(design: RobotDesign, name: str, model: RigidBodyModel | None = None) -> np.ndarray:
    """Compute a named posture, both legs alike and the lower pads on the floor.

    In `standing`, the knees are bent by 20 deg and the soles are flat. In `mid_squat`, they are
    bent by 80 deg. In `toe_off`, the heels are up by 30 deg and only the pads of the tip touch the
    floor; the toes are flat where they move. All these numbers are assumed.

    Args:
        design: one robot.
        name: of the posture; `default` for a robot that describes its own tree.
        model: the design's rigid-body model, to save making it.

    Returns:
        Configuration in Pinocchio's coordinates, `(nq,)`.

    Raises:
        InputError: no such posture, or a batch.
        InfeasibleError: a joint's range ends before.
    """
    model = model or rigid_body_model(design)
    if isinstance(design, TreeDesign):
        if name != "default":
            raise InputError("posture", "", name, "expects default, the design's own posture")
        q = model.neutral()
        start = 7 if model.floating else 0
        q[start:] = [joint.default for joint in model.tree.moving]
        if model.floating:
            q[2] -= float(contact_points(model, q)[:, 2].min(initial=np.inf))
        return q
    if name not in POSTURES:
        raise InputError("posture", "", name, f"expects one of {', '.join(POSTURES)}")
    design = cast("Design", design)
    pitch = np.asarray(_HEEL_PITCH if name == "toe_off" else 0.0)
    moved = rolling(design, TIP, np.array([[float(pitch)], [0.0], [0.0]]))[0, 0]
    ankle = np.array([moved[0], 0.0, design.foot.ankle_height + moved[1]])
    reach, ahead = leg_reach(design, float(_KNEE[name])), _AHEAD[name] - moved[0]
    q = model.neutral()
    q[0], q[2] = _AHEAD[name], ankle[2] + np.sqrt(reach**2 - ahead**2)
    joints = len(joint_names(design))
    for leg, side in enumerate(SIDES):
        hip = hip_center(design, side)
        foot = ankle + np.array([0.0, hip[1], 0.0])
        angles = list(leg_angles(design, side, foot - q[:3] - hip, about_y(pitch)))
        if has_toe_joint(design):
            angles.append(-float(pitch))
        check_range(design, side, np.array(angles))
        q[7 + leg * joints : 7 + (leg + 1) * joints] = angles
    return q
