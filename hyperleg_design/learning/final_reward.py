"""The reward that a training ends with, and from which step it learns under that reward alone.

Helpers (assist, guiding reward terms, weights that are still being faded in) may shape the
beginning of a training. A preset states with `final_share` for how much of a training's end they
must be gone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from hyperleg_design.errors import InputError

if TYPE_CHECKING:
    from hyperleg_design.learning.preset import Stage


def settled_after(stages: Sequence[Stage]) -> float:
    """Policy steps after which neither reward, gait clock nor assist changes any more, at the
    latest.

    A ramp that begins when the assist is gone counts from the stage's deadline for the assist.

    Args:
        stages: of one task, in order.

    Returns:
        Steps from the beginning; infinite where a ramp of a reward may be cut off by the end of its
        stage, because the final reward then depends on how the training goes.
    """
    begun, settled, assisted = 0.0, 0.0, False
    for stage in stages:
        if stage.rewards:
            settled = max(settled, begun)
        assisted = assisted if stage.assist is None else stage.assist > 0.0
        deadline = stage.assist_gone_by * stage.steps if assisted else 0.0
        if assisted:
            settled = max(settled, begun + deadline)
            assisted = stage.assist_gone_by >= 1.0  # goes on into the next stage otherwise
        for ramp in stage.ramps:
            if ramp.target[0] not in ("rewards", "clock"):
                continue
            end = ramp.steps + (deadline if ramp.begins == "assist_gone" else 0.0)
            if end > stage.steps * (1 + 1e-9):
                return float("inf")
            settled = max(settled, begun + end)
        begun += stage.steps
    return settled


def final_share(stages: Sequence[Stage]) -> float:
    """Compute the share of all steps, at the end, that is learnt under the final reward without
    assist.

    Args:
        stages: of the training.

    Returns:
        The share [-].
    """
    total = sum(stage.steps for stage in stages)
    return max(0.0, 1.0 - settled_after(stages) / total)


def check_final_share(stages: Sequence[Stage], least: float, where: str, path: str) -> None:
    """Whether helpers are gone early enough.

    Args:
        stages: of one task.
        least: share of all steps that must run under the final reward.
        where: file, for the error.
        path: field, for the error.

    Raises:
        InputError: they are not.
    """
    share = final_share(stages)
    if share < least:
        raise InputError(
            where,
            path,
            round(share, 3),
            f"is the share of steps under the final reward without assist; final_share asks for "
            f"{least:g}: end ramps of rewards and the assist earlier, or lengthen the last stage",
        )
