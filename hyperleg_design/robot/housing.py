"""Which link of an imported robot carries the motor of a joint, and where in that link it sits."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from hyperleg_design.robot.described_file import FileRobot
from hyperleg_design.robot.trees.tree_limb import turned


def housing(robot: FileRobot, joint: str, locked: Collection[str] = ()) -> tuple[str, np.ndarray]:
    """Find the link that carries the motor of a joint, which is taken to sit at the joint.

    That is the parent link, unless a link that does not move against it is heavier: the root of
    many URDFs is a frame without mass, to which the real trunk is fixed.

    Args:
        robot: as its file describes it.
        joint: whose motor it is.
        locked: joints that do not move, besides those of type `fixed`.

    Returns:
        The link, and the origin of the joint in the frame of that link [m], `(3,)`.
    """
    own = robot.joints[joint]
    places = {own.parent: own.position}
    rigid = [j for name, j in robot.joints.items() if j.kind == "fixed" or name in locked]
    grown = True
    while grown:
        grown = False
        for fixed in rigid:
            turn = turned(np.rad2deg(fixed.turn))
            if fixed.parent in places and fixed.child not in places:
                places[fixed.child] = turn.T @ (places[fixed.parent] - fixed.position)
            elif fixed.child in places and fixed.parent not in places:
                places[fixed.parent] = turn @ places[fixed.child] + fixed.position
            else:
                continue
            grown = True
    heaviest = max(places, key=lambda link: robot.links[link].mass)  # the parent among equals
    return heaviest, places[heaviest]
