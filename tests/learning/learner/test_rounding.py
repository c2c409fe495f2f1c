from __future__ import annotations

import copy

import pytest

torch = pytest.importorskip("torch")

from hyperleg_design.learning.learner.rounding import RoundedLinear, round_layers  # noqa: E402

nn = torch.nn


def gradients(network, values, mixed: bool):
    with torch.autocast("cpu", enabled=mixed, dtype=torch.bfloat16):
        loss = (network(values) ** 2).mean()
    network.zero_grad()
    loss.backward()
    return torch.cat([each.grad.flatten() for each in network.parameters()]), loss.detach()


@pytest.fixture
def networks():
    torch.manual_seed(0)
    plain = nn.Sequential(
        nn.Linear(65, 128), nn.ELU(), nn.Linear(128, 64), nn.ELU(), nn.Linear(64, 14)
    )
    rounded = copy.deepcopy(plain)
    round_layers(rounded)
    return plain, rounded, torch.randn(256, 65)


def test_rounded_layers_are_those_of_autocast_but_for_the_order_of_sums(networks) -> None:
    plain, rounded, values = networks
    native, loss = gradients(plain, values, mixed=True)
    ours, our_loss = gradients(rounded, values, mixed=True)
    exact, _ = gradients(plain, values, mixed=False)
    assert our_loss.dtype == loss.dtype
    assert float(our_loss) == pytest.approx(float(loss), rel=1e-4)
    assert (ours - native).norm() < 0.35 * (exact - native).norm()
    assert (exact - ours).norm() == pytest.approx(float((exact - native).norm()), rel=0.1)


def test_outputs_are_bfloat16_under_autocast_and_the_plain_layer_s_without(networks) -> None:
    plain, rounded, values = networks
    assert torch.equal(plain(values), rounded(values))
    with torch.autocast("cpu", dtype=torch.bfloat16):
        assert rounded(values).dtype == plain(values).dtype == torch.bfloat16


def test_a_rounded_network_keeps_its_weights_and_their_names(networks) -> None:
    plain, rounded, _ = networks
    assert list(plain.state_dict()) == list(rounded.state_dict())
    assert all(
        torch.equal(a, b)
        for a, b in zip(plain.state_dict().values(), rounded.state_dict().values(), strict=True)
    )
    assert sum(isinstance(layer, RoundedLinear) for layer in rounded.modules()) == 3
