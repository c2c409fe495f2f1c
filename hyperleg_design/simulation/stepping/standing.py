"""Whether a robot can stand in its default posture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InputError, of_batch
from hyperleg_design.simulation.settings import Limits

if TYPE_CHECKING:
    import mujoco

    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.simulation.layout import Layout


POSTURE = "default posture"
"""What errors name as the field."""
LEAN = 0.1
"""How far from a narrow row of pads the centre of mass may be, over its height [-]: a robot on
point feet cannot stand still anywhere, but it can catch itself with a step. 0.1 is 6 degrees."""


def check_standing(model: mujoco.MjModel, layout: Layout, limits: Limits, name: str) -> None:
    """Check that a robot can stand in its default posture.

    Args:
        model: its compiled model.
        layout: of the robot.
        limits: at which height a robot counts as fallen.
        name: of the robot, for error messages.

    Raises:
        InputError: its base would be under its feet or under the height that counts as fallen, or
            its weight beside its soles (further than `LEAN` beside point feet).
    """
    import mujoco

    if not layout.default_height > 0:
        remedy = (
            f"the {layout.base} is no higher than the pads in the default posture; change "
            f"joints.*.default_deg"
        )
        raise InputError(name, POSTURE, round(float(layout.default_height), 4), remedy)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    height, least = float(data.qpos[2]), float(limits.of(layout.default_height).height)
    if height <= least:
        remedy = (
            f"the {layout.base} stands lower than a fall, {least:g} m; set limits.height or "
            f"limits.height_share of the task, or longer legs"
        )
        raise InputError(name, POSTURE, round(height, 4), remedy)
    pads = np.array([data.geom(pad).xpos[:2] for pad in layout.pads])
    begin, end, (*middle, above) = pads.min(0), pads.max(0), data.subtree_com[1]
    beside = np.maximum(begin - middle, middle - end)
    if np.any(beside > np.where(end - begin < LEAN * above, LEAN * above, 0.0)):
        place, soles = (np.round(values, 3) + 0.0 for values in (middle, [begin, end]))
        remedy = (
            f"the centre of mass, x and y in m, lies beside the soles, which reach from "
            f"{soles[0].tolist()} to {soles[1].tolist()}; change joints.*.default_deg, or "
            f"posture_deg of the task"
        )
        raise InputError(name, POSTURE, place.tolist(), remedy)


def check_all_standing(
    designs: Sequence[RobotDesign],
    models: Sequence[mujoco.MjModel],
    layouts: Sequence[Layout],
    limits: Limits,
) -> None:
    """Check that all robots of a batch can stand in their default postures.

    Args:
        designs: the robots.
        models: their compiled models.
        layouts: of the robots.
        limits: at which height a robot counts as fallen.

    Raises:
        InputError: the first reason why robots cannot stand; its `bad` marks them.
    """
    errors: dict[int, InputError] = {}
    for i, (design, model, layout) in enumerate(zip(designs, models, layouts, strict=True)):
        try:
            check_standing(model, layout, limits, design.name)
        except InputError as error:
            errors[i] = error
    if errors:
        raise of_batch(errors, len(designs))
