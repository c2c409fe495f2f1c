from __future__ import annotations

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from hyperleg_design.learning.learner.modulation import ModulatedLayers, plain_layers  # noqa: E402


def network() -> ModulatedLayers:
    torch.manual_seed(0)
    layers = torch.nn.Sequential(
        torch.nn.Linear(5, 7), torch.nn.ELU(), torch.nn.Linear(7, 4), torch.nn.ELU()
    )
    layers.append(torch.nn.Linear(4, 2))
    return ModulatedLayers(layers, [1, 4])


def test_begins_as_the_plain_network() -> None:
    modulated = network()
    values = torch.randn(11, 5)
    torch.testing.assert_close(modulated(values), plain_layers(modulated)(values))


def test_scales_and_shifts_each_hidden_layer_by_the_design() -> None:
    modulated = network()
    for part in (*modulated.scales, *modulated.shifts):
        torch.nn.init.normal_(part.weight)
    values = torch.randn(6, 5)
    x, d = values.detach().numpy(), values[:, [1, 4]].detach().numpy()
    weights = [
        (layer.weight.detach().numpy(), layer.bias.detach().numpy())
        for layer in modulated.layers
        if isinstance(layer, torch.nn.Linear)
    ]
    for i, (weight, bias) in enumerate(weights):
        x = x @ weight.T + bias
        if i < 2:
            scale, shift = (
                d @ part[i].weight.detach().numpy().T + part[i].bias.detach().numpy()
                for part in (modulated.scales, modulated.shifts)
            )
            x = scale * x + shift
            x = np.where(x > 0, x, np.expm1(x))
    np.testing.assert_allclose(modulated(values).detach().numpy(), x, rtol=1e-4, atol=1e-5)
