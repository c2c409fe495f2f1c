"""Policies as ONNX files that say by themselves what they are: normaliser, layout, design, task,
seed and commit inside.

The format is that of `simulation/policy_file.py`.
"""

from __future__ import annotations

import io
import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from hyperleg_design.errors import OutputError
from hyperleg_design.learning.learner.modulation import ModulatedLayers, plain_layers
from hyperleg_design.simulation.policy_file import INPUT, OUTPUT, POLICY_FORMAT
from hyperleg_design.writing import write_bytes

if TYPE_CHECKING:
    from rsl_rl.models import MLPModel

TOLERANCE = 1e-5
"""Largest difference between torch and ONNX Runtime, over 1 + the largest of each output."""
OPSET = 18


def export_policy(
    path: Path, actor: MLPModel, metadata: dict[str, Any], form: str = POLICY_FORMAT
) -> Path:
    """Write the deterministic policy of an actor, or a critic, and check it against torch.

    Args:
        path: of the file.
        actor: the network with its normaliser.
        metadata: what goes into the file besides `format`; texts as they are, the rest as JSON.
        form: the file's format, `POLICY_FORMAT` or `CRITIC_FORMAT`.

    Returns:
        The path of the file.

    Raises:
        OutputError: ONNX Runtime disagrees with torch, or the file cannot be written.
    """
    content = _as_onnx(actor, {"format": form, **metadata})
    difference = largest_difference(content, actor)
    if not difference <= TOLERANCE:
        raise OutputError(
            f"{path}: the exported policy differs from the trained one by {difference:.2g}; "
            f"nothing was written"
        )
    return write_bytes(path, content)


def largest_difference(content: bytes, actor: MLPModel, count: int = 64) -> float:
    """Compare the actions of an ONNX file with those of torch, on observations as the normaliser
    has seen them.

    Args:
        content: of the ONNX file.
        actor: the network in torch.
        count: number of observations.

    Returns:
        The largest difference over 1 + the largest of each output [-]: a small value among large
        ones, as a critic's, is a difference of large numbers.
    """
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    session = onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
    rng = np.random.default_rng(0)
    normaliser = actor.obs_normalizer
    deviation = normaliser.std.numpy() if actor.obs_normalization else 1.0
    mean = normaliser.mean.numpy() if actor.obs_normalization else 0.0
    observation = (mean + 2.0 * deviation * rng.normal(size=(count, actor.obs_dim))).astype(
        np.float32
    )
    with torch.inference_mode():
        expected = actor.mlp(actor.obs_normalizer(torch.from_numpy(observation))).numpy()
    (action,) = session.run([OUTPUT], {INPUT: observation})
    return float(np.max(np.abs(action - expected) / (1.0 + np.abs(expected).max(0))))


def _as_onnx(actor: MLPModel, metadata: dict[str, Any]) -> bytes:
    """The bytes of the file: subtract mean, divide by deviation, then the layers."""
    import onnx
    from onnx import TensorProto, helper, numpy_helper

    nodes: list[Any] = []
    weights: list[Any] = []
    name, outputs = INPUT, 0

    def add(kind: str, inputs: list[str], **attributes: Any) -> str:
        output = f"{kind.lower()}_{len(nodes)}"
        nodes.append(helper.make_node(kind, inputs, [output], **attributes))
        return output

    def constant(label: str, values: torch.Tensor) -> str:
        weights.append(
            numpy_helper.from_array(
                np.ascontiguousarray(values.detach().numpy(), np.float32), label
            )
        )
        return label

    if actor.obs_normalization:
        normaliser = actor.obs_normalizer
        name = add("Sub", [name, constant("mean", normaliser._mean)])
        name = add("Div", [name, constant("deviation", normaliser._std + normaliser.eps)])

    def linear(value: str, layer: torch.nn.Linear, label: str, ending: str) -> str:
        parts = [
            constant(f"{label}weight_{ending}", layer.weight),
            constant(f"{label}bias_{ending}", layer.bias),
        ]
        return add("Gemm", [value, *parts], transB=1)

    modulated = actor.mlp if isinstance(actor.mlp, ModulatedLayers) else None
    design, hidden = "", 0
    if modulated is not None:
        weights.append(numpy_helper.from_array(modulated.columns.numpy(), "design_columns"))
        design = add("Gather", [name, "design_columns"], axis=1)
    for i, layer in enumerate(plain_layers(actor.mlp)):
        if isinstance(layer, torch.nn.Linear):
            name = linear(name, layer, "", str(i))
            outputs = layer.out_features
            if modulated is not None and hidden < len(modulated.scales):
                scale = linear(design, modulated.scales[hidden], "scale_", str(i))
                shift = linear(design, modulated.shifts[hidden], "shift_", str(i))
                name = add("Add", [add("Mul", [scale, name]), shift])
                hidden += 1
        else:
            name = add({"ELU": "Elu", "ReLU": "Relu", "Tanh": "Tanh"}[type(layer).__name__], [name])
    nodes[-1].output[0] = OUTPUT
    graph = helper.make_graph(
        nodes,
        "policy",
        [helper.make_tensor_value_info(INPUT, TensorProto.FLOAT, ["n", actor.obs_dim])],
        [helper.make_tensor_value_info(OUTPUT, TensorProto.FLOAT, ["n", outputs])],
        weights,
    )
    model = helper.make_model(
        graph, opset_imports=[helper.make_opsetid("", OPSET)], producer_name="hyperleg-design"
    )
    model.ir_version = 10
    helper.set_model_props(
        model,
        {
            key: value if isinstance(value, str) else json.dumps(value)
            for key, value in metadata.items()
        },
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        onnx.checker.check_model(model)
    stream = io.BytesIO()
    onnx.save_model(model, stream)
    return stream.getvalue()
