"""The reference motions by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from hyperleg_design.errors import InputError, meant
from hyperleg_design.sizing.motions.hop import HopPlan, hop
from hyperleg_design.sizing.motions.motion import Motion
from hyperleg_design.sizing.motions.squat import SquatPlan, squat
from hyperleg_design.sizing.motions.stair import StairPlan, stair
from hyperleg_design.sizing.motions.walk import WalkPlan, walk

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design

_PLANNERS: Mapping[str, tuple[Callable[..., Motion], Callable[..., Any]]] = {
    "walk": (walk, WalkPlan),
    "stair": (stair, StairPlan),
    "squat": (squat, SquatPlan),
    "hop": (hop, HopPlan),
}
MOTIONS = tuple(_PLANNERS)
"""Names of the reference motions."""


def reference_motion(
    design: Design, name: str, *, samples: int | None = None, **plan: float
) -> Motion:
    """Plan a reference motion of one robot.

    Args:
        design: a robot, of any variant.
        name: one of `MOTIONS`.
        samples: of the motion; its own number by default.
        plan: fields of the motion's plan that differ, such as `speed` of the walk.

    Returns:
        The motion.

    Raises:
        InputError: no such motion or field, or a batch of designs.
        InfeasibleError: the legs cannot do it; says which joint or length stops them.
    """
    if name not in _PLANNERS:
        raise InputError("motion", "", name, meant(name, MOTIONS))
    if design.batch_shape:
        raise InputError(design.name, "", None, "holds a batch of designs; take one of them")
    planner, plan_type = _PLANNERS[name]
    known = plan_type.__dataclass_fields__  # type: ignore[attr-defined]
    for field, value in plan.items():
        if field not in known:
            raise InputError(name, field, value, f"is no part of the plan; {meant(field, known)}")
    counted = {} if samples is None else {"samples": samples}
    return planner(design, plan_type(**plan), **counted)
