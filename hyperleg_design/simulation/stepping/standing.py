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


def check_standing(model: mujoco.MjModel, layout: Layout, limits: Limits, name: str) -> None:
    """Check that a robot can stand in its default posture.

    Args:
        model: its compiled model.
        layout: of the robot.
        limits: at which height a robot counts as fallen.
        name: of the robot, for error messages.

    Raises:
        InputError: its base would be under its feet or under the height that counts as fallen, or
            its weight beside its soles.
    """
    import mujoco

    if not layout.default_height > 0:
        remedy = (
            f"the {layout.base} is no higher than the pads in the default posture; change "
            f"joints.*.default_deg"
        )
        raise InputError(name, "", round(float(layout.default_height), 4), remedy)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    height, least = float(data.qpos[2]), float(limits.of(layout.default_height).height)
    if height <= least:
        remedy = (
            f"the {layout.base} stands lower than a fall, {least:g} m; set limits.height or "
            f"limits.height_share of the task, or longer legs"
        )
        raise InputError(name, "", round(height, 4), remedy)
    pads = np.array([data.geom(pad).xpos[:2] for pad in layout.pads])
    middle = data.subtree_com[1][:2]
    if np.any(middle < pads.min(0)) or np.any(middle > pads.max(0)):
        remedy = (
            "the centre of mass lies beside the soles in the default posture; change "
            "joints.*.default_deg"
        )
        raise InputError(name, "", np.round(middle, 4).tolist(), remedy)


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
