from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from hyperleg_design.errors import OutputError

torch = pytest.importorskip("torch")
onnxruntime = pytest.importorskip("onnxruntime")
pytest.importorskip("onnx")
pytest.importorskip("rsl_rl")

from hyperleg_design.learning.learner.algorithm import as_tensors, make_network  # noqa: E402
from hyperleg_design.learning.policies import export  # noqa: E402
from hyperleg_design.learning.preset import Network  # noqa: E402
from hyperleg_design.simulation.policy_file import POLICY_FORMAT  # noqa: E402


def actor(
    activation: str = "elu", normalised: bool = True, hidden: tuple[int, ...] = (512, 256, 128)
):
    torch.manual_seed(0)
    rng = np.random.default_rng(0)
    values = (rng.normal(size=(500, 67)) * rng.uniform(0.01, 30, 67) + rng.normal(size=67)).astype(
        np.float32
    )
    made = make_network(
        Network(hidden=hidden, activation=activation, normalised=normalised),
        as_tensors({"policy": values}),
        "actor",
        14,
    )
    with torch.no_grad():
        made.mlp[-1].weight.mul_(100.0)
    made.train()
    made.update_normalization(as_tensors({"policy": values}))
    return made, values


@pytest.mark.parametrize(
    ("activation", "normalised"), [("elu", True), ("relu", False), ("tanh", True)]
)
def test_onnx_runtime_gives_what_rsl_rl_gives(
    tmp_path: Path, activation: str, normalised: bool
) -> None:
    made, values = actor(activation, normalised)
    path = export.export_policy(
        tmp_path / "policy.onnx", made, {"seed": "3", "columns": ["a", "b"]}
    )
    session = onnxruntime.InferenceSession(str(path))
    for count in (1, 37):
        with torch.inference_mode():
            expected = made(as_tensors({"policy": values[:count]})).numpy()
        (action,) = session.run(["action"], {"observation": values[:count]})
        np.testing.assert_allclose(action, expected, rtol=1e-5, atol=2e-5)
    metadata = session.get_modelmeta().custom_metadata_map
    assert metadata["format"] == POLICY_FORMAT
    assert metadata["seed"] == "3"
    assert json.loads(metadata["columns"]) == ["a", "b"]


def test_the_paper_s_network_takes_under_two_megabytes(tmp_path: Path) -> None:
    made, _ = actor()
    assert 0.5e6 < export.export_policy(tmp_path / "policy.onnx", made, {}).stat().st_size < 2e6


def test_a_policy_that_differs_is_not_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made, _ = actor(hidden=(8,))
    original = export._as_onnx

    def wrong(network, metadata):
        with torch.no_grad():
            network.mlp[0].bias[0] += 0.1
            content = original(network, metadata)
            network.mlp[0].bias[0] -= 0.1
        return content

    monkeypatch.setattr(export, "_as_onnx", wrong)
    with pytest.raises(OutputError, match="differs"):
        export.export_policy(tmp_path / "policy.onnx", made, {})
    assert not list(tmp_path.iterdir())
