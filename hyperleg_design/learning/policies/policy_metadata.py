"""What a policy's file says of how it was trained."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hyperleg_design.simulation.design_observation import RANGES

if TYPE_CHECKING:
    from hyperleg_design.simulation.design_observation import DesignRanges

KEYS = (
    "variant",
    "seed",
    "task",
    "design",
    "preset",
    "deviations",
    "start",
    "command",
    "commit",
    "versions",
)
"""Parts of a training's description that its policies carry."""
WHERE_GIVEN = ("overlay", "designs")
"""Parts that they carry where the training has them."""


def policy_metadata(
    description: Mapping[str, Any],
    *,
    steps: int,
    columns: Sequence[str],
    joints: Sequence[str],
    designs: DesignRanges | None,
) -> dict[str, Any]:
    """Collect the metadata of a policy.

    Args:
        description: of the training, as `resolved.describe` gives it.
        steps: policy steps that the policy was trained for.
        columns: names of the numbers that it observes, in order.
        joints: names of the joints that its actions move, in order.
        designs: ranges of a policy that observes its design.

    Returns:
        Texts, numbers and nested mappings by name.
    """
    chosen = (*KEYS, *(key for key in WHERE_GIVEN if description.get(key)))
    metadata = {key: description[key] for key in chosen}
    metadata |= {"seed": str(description["seed"]), "steps": str(steps)}
    metadata |= {"columns": list(columns), "joints": list(joints)}
    if designs is not None:
        metadata[RANGES] = designs.to_mapping()
    return metadata
