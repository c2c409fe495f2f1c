from __future__ import annotations

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from hyperleg_design.learning.learner.modulation import ModulatedLayers  # noqa: E402
from hyperleg_design.learning.policies.fold_design import fold_design  # noqa: E402


@pytest.mark.parametrize("modulated", [True, False])
def test_the_folded_network_gives_the_same_outputs(modulated: bool) -> None:
    """Against torch's own evaluation of the modulated layers, in double precision."""
    torch.manual_seed(0)
    rng = np.random.default_rng(0)
    names = ("design.a", "speed", "design.b", "height")
    linear = [torch.nn.Linear(4, 6), torch.nn.Linear(6, 5), torch.nn.Linear(5, 3)]
    plain = torch.nn.Sequential(linear[0], torch.nn.ELU(), linear[1], torch.nn.ELU(), linear[2])
    layers = ModulatedLayers(plain, [0, 2]) if modulated else plain
    layers.double()
    for parameter in layers.parameters():
        torch.nn.init.normal_(parameter)

    def arrays(layer: torch.nn.Linear) -> tuple[np.ndarray, np.ndarray]:
        return layer.weight.detach().numpy(), layer.bias.detach().numpy()

    network = {
        "columns": names,
        "mean": rng.normal(size=4),
        "deviation": rng.uniform(0.5, 2.0, 4),
        "weights": tuple(arrays(layer)[0] for layer in linear),
        "biases": tuple(arrays(layer)[1] for layer in linear),
    }
    modulation = {
        place: (*arrays(layers.scales[place]), *arrays(layers.shifts[place]))
        for place in range(2 if modulated else 0)
    }
    folded = fold_design(network, modulation, {"design.b": 0.7, "design.a": -0.4})
    assert folded["columns"] == ("speed", "height")

    values = rng.normal(size=(20, 4))
    values[:, 0], values[:, 2] = -0.4, 0.7
    normalised = (values - network["mean"]) / network["deviation"]
    expected = layers(torch.from_numpy(normalised)).detach().numpy()
    hidden = (values[:, [1, 3]] - folded["mean"]) / folded["deviation"]
    for i, (weight, bias) in enumerate(zip(folded["weights"], folded["biases"], strict=True)):
        hidden = hidden @ weight.T + bias
        if i < 2:
            hidden = np.where(hidden > 0, hidden, np.expm1(np.minimum(hidden, 0)))
    np.testing.assert_allclose(hidden, expected, rtol=1e-10, atol=1e-10)
