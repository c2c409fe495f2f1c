"""Networks whose hidden features are modulated by the robot's design.

Each hidden layer's outputs h become a(d) h + b(d) before the activation, with scale a and shift b
linear in the design d: feature-wise linear modulation (FiLM; Perez et al., AAAI 2018). At first a
is 1 and b is 0, so that the network begins as one without modulation. A critic that is shared by
many robots averages their values unless it can tell the robots apart.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor, nn


class ModulatedLayers(nn.Module):  # type: ignore[misc]
    """A multi-layer perceptron, modulated by some of its inputs.

    Args:
        layers: linear layers and activations in turn, the last one linear.
        columns: places of the design's numbers in the input.
    """

    def __init__(self, layers: nn.Sequential, columns: Sequence[int]) -> None:
        super().__init__()
        self.layers = layers
        self.register_buffer("columns", torch.tensor(list(columns), dtype=torch.long))
        widths = [layer.out_features for layer in layers if isinstance(layer, nn.Linear)][:-1]
        self.scales = nn.ModuleList(_constant(len(columns), width, 1.0) for width in widths)
        self.shifts = nn.ModuleList(_constant(len(columns), width, 0.0) for width in widths)

    def forward(self, values: Tensor) -> Tensor:
        """Compute the outputs of the network.

        Args:
            values: inputs, `(..., in)`.

        Returns:
            `(..., out)`.
        """
        design, hidden = values[..., self.columns], 0
        for layer in self.layers:
            values = layer(values)
            if isinstance(layer, nn.Linear) and hidden < len(self.scales):
                values = self.scales[hidden](design) * values + self.shifts[hidden](design)
                hidden += 1
        return values


def plain_layers(network: nn.Module) -> nn.Sequential:
    """Find the perceptron of a network.

    Args:
        network: with or without modulation.

    Returns:
        Its layers without the modulation.
    """
    layers = network.layers if isinstance(network, ModulatedLayers) else network
    assert isinstance(layers, nn.Sequential)
    return layers


def _constant(inputs: int, outputs: int, value: float) -> nn.Linear:
    """A linear layer that gives the same value at first."""
    layer = nn.Linear(inputs, outputs)
    nn.init.zeros_(layer.weight)
    nn.init.constant_(layer.bias, value)
    return layer
