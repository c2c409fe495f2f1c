"""Mixed precision on processors that cannot multiply bfloat16: the same roundings, multiplied in
float32, about three times as fast.

A product of two bfloat16 numbers is exact in float32, so layers that round what they take and what
they give differ from native ones only in the order of their sums. Trainings are then alike on any
processor.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

NATIVE = ("amx_bf16", "avx512_bf16", "bf16")
"""Capabilities of processors that multiply bfloat16 themselves, as torch names them."""


class RoundedLinear(nn.Linear):  # type: ignore[misc]
    """Linear layer that does in float32 what autocast does in bfloat16; plain without autocast."""

    def forward(self, values: Tensor) -> Tensor:
        """Apply the layer; under autocast, operands and result are rounded to bfloat16.

        Args:
            values: `(..., in)`.

        Returns:
            `(..., out)`.
        """
        if not torch.is_autocast_enabled("cpu"):
            return super().forward(values)
        with torch.autocast("cpu", enabled=False):
            rounded = (each.bfloat16().float() for each in (values, self.weight, self.bias))
            return nn.functional.linear(*rounded).bfloat16()


def multiplies_bfloat16() -> bool:
    """Find out whether this processor multiplies bfloat16 itself.

    Returns:
        True if it does.
    """
    capabilities = torch.cpu.get_capabilities()
    return any(capabilities.get(name, False) for name in NATIVE)


def round_layers(network: nn.Module) -> None:
    """Replace the linear layers of a network by rounded ones, in place.

    Args:
        network: which is changed.
    """
    for layer in network.modules():
        if type(layer) is nn.Linear:
            layer.__class__ = RoundedLinear
