"""Whether the rods of a design can move anything: their links, cranks, levers and axes."""

from __future__ import annotations

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.checks.refusal import refuse
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.robot.trees.tree_limb import ancestors, link_frames

SHORTEST = 1e-6
"""Length up to which a crank, lever or rod counts as none [m]."""
IN_LINE = 1e-6
"""Sine of an angle up to which two directions count as one [-]."""


def check_rods(design: TreeDesign, where: str) -> None:
    """Check each rod in the zero posture, before anybody solves for the turn of its crank.

    Args:
        design: a robot or batch whose joints and links fit together.
        where: file that it comes from, for errors.

    Raises:
        InputError: a link that no joint moves against the carrier, a crank, lever or rod of length
            zero, or an axis about which the rod does not turn the crank.
    """
    for motor in design.rod_sections:
        _check_end(design, motor, where)
        _check_points(design, motor, where)


def spanned(design: TreeDesign, motor: str) -> list[str]:
    """List the joints between the two links of a rod.

    Args:
        design: a robot or batch.
        motor: that turns the rod's crank.

    Returns:
        Names of those that move; none where the rod's end does not lie behind its carrier.
    """
    rod = design.rod_sections[motor]
    return _between(design, str(rod.carrier), str(rod.end))


def _between(design: TreeDesign, carrier: str, end: str) -> list[str]:
    before, behind = ancestors(design, carrier), ancestors(design, end)
    if behind[: len(before)] != before:
        return []
    return [joint for joint in behind[len(before) :] if joint in design.joint_sections]


def _check_end(design: TreeDesign, motor: str, where: str) -> None:
    rod = design.rod_sections[motor]
    if spanned(design, motor):
        return
    carrier = str(rod.carrier)
    behind = [link for link in design.link_sections if _between(design, carrier, link)]
    remedy = (
        f"no joint moves it against the carrier {carrier}; the links behind joints of {carrier} "
        f"are {parameters.some(behind)}"
        if behind
        else f"no joint lies behind the carrier {carrier}; name another carrier"
    )
    raise InputError(where, f"rods.{motor}.end", str(rod.end), remedy)


def _check_points(design: TreeDesign, motor: str, where: str) -> None:
    rod, frames = design.rod_sections[motor], link_frames(design)
    axis = np.asarray(rod.axis, float)
    origin, crank_end = np.asarray(rod.crank_axis, float), np.asarray(rod.crank_end, float)
    crank = crank_end - origin
    across = np.linalg.norm(np.cross(axis, crank), axis=-1)
    remedy = "lies on the crank's axis, so that the crank has length 0; move it off that axis"
    refuse(where, f"rods.{motor}.crank_end", across > SHORTEST, crank_end, remedy)
    (rotation, place), (turn, start) = frames[str(rod.carrier)], frames[str(rod.end)]
    rod_end = np.asarray(rod.rod_end, float)
    world = start + (turn @ rod_end[..., None])[..., 0]
    own = (np.swapaxes(rotation, -1, -2) @ (world - place)[..., None])[..., 0]
    levers = []
    names = spanned(design, motor)
    for name in names:
        joint = design.joint_sections[name]
        facing, at = frames[str(joint.child)]
        about = (facing @ np.asarray(joint.axis, float)[..., None])[..., 0]
        levers.append(np.linalg.norm(np.cross(about, world - at), axis=-1))
    longest = np.max(np.stack(np.broadcast_arrays(*levers)), 0)
    remedy = f"lies on the axis of {' and '.join(names)}, so that its lever has length 0; move it"
    refuse(where, f"rods.{motor}.rod_end", longest > SHORTEST, rod_end, f"{remedy} off that axis")
    along = own - crank_end
    length = np.linalg.norm(along, axis=-1)
    remedy = "is the place of crank_end in the zero posture, so that the rod has length 0; move one"
    refuse(where, f"rods.{motor}.rod_end", length > SHORTEST, rod_end, f"{remedy} of the two")
    normal = np.cross(crank, along)
    size = np.linalg.norm(crank, axis=-1) * length
    remedy = (
        "is in line with the crank's axis and the rod in the zero posture, a dead centre; move it "
        "out of that line"
    )
    apart = np.linalg.norm(normal, axis=-1) > IN_LINE * size
    refuse(where, f"rods.{motor}.crank_end", apart, crank_end, remedy)
    moment = np.abs(np.sum(axis * normal, axis=-1))
    remedy = (
        "is not across crank and rod: it lies in the plane of the two, so that the rod does not "
        "turn the crank; give the direction about which the crank turns"
    )
    refuse(where, f"rods.{motor}.axis", moment > IN_LINE * across * length, axis, remedy)
