"""Links and hinges of a compiled MuJoCo model, as a chain has them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from hyperleg_design.validation.blind.robots.chain import Link, steiner


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
    # link, its frame's rotation and place of the body
    home: dict[int, tuple[int, np.ndarray, np.ndarray]] = {0: (-1, np.eye(3), np.zeros(3))}
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
