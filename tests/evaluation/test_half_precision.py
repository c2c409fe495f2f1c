"""Weights in half precision: half the file, the same network but for the rounding."""

from __future__ import annotations

import itertools

import numpy as np
import onnxruntime
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.half_precision import halve_weights

onnx = pytest.importorskip("onnx")
from onnx import TensorProto, helper, numpy_helper  # noqa: E402

SIZES = (40, 64, 32, 14)


@pytest.fixture
def network():
    """A network as trainings export it: normaliser, three layers, metadata."""
    rng = np.random.default_rng(4)
    arrays = {"mean": rng.normal(size=(1, SIZES[0])), "deviation": rng.uniform(1, 2, (1, SIZES[0]))}
    nodes = [
        helper.make_node("Sub", ["observation", "mean"], ["centred"]),
        helper.make_node("Div", ["centred", "deviation"], ["layer_0"]),
    ]
    for i, (inputs, outputs) in enumerate(itertools.pairwise(SIZES)):
        arrays[f"weight_{i}"] = rng.normal(size=(outputs, inputs)) / np.sqrt(inputs)
        arrays[f"bias_{i}"] = rng.normal(size=outputs)
        names = [f"layer_{i}", f"weight_{i}", f"bias_{i}"]
        nodes.append(helper.make_node("Gemm", names, [f"layer_{i + 1}"], transB=1))
    nodes[-1].output[0] = "action"
    graph = helper.make_graph(
        nodes,
        "policy",
        [helper.make_tensor_value_info("observation", TensorProto.FLOAT, ["n", SIZES[0]])],
        [helper.make_tensor_value_info("action", TensorProto.FLOAT, ["n", SIZES[-1]])],
        [numpy_helper.from_array(v.astype(np.float32), k) for k, v in arrays.items()],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)])
    model.ir_version = 10
    helper.set_model_props(model, {"format": "hyperleg-policy-1", "seed": "3"})
    return model.SerializeToString()


def _run(content, observation):
    session = onnxruntime.InferenceSession(content, providers=["CPUExecutionProvider"])
    return session.run(["action"], {"observation": observation})[0]


def test_the_file_shrinks_and_its_metadata_stays(network):
    small = halve_weights(network)
    numbers = sum(a * b for a, b in itertools.pairwise(SIZES))
    assert len(network) - len(small) == pytest.approx(2 * numbers, rel=0.1)
    props = {p.key: p.value for p in onnx.load_from_string(small).metadata_props}
    assert props == {"format": "hyperleg-policy-1", "seed": "3"}


def test_actions_are_those_of_the_rounded_weights(network):
    """The same as rounding the matrices by NumPy, and near the network as it was."""
    rounded = onnx.load_from_string(network)
    for tensor in rounded.graph.initializer:
        if tensor.name.startswith("weight"):
            values = numpy_helper.to_array(tensor).astype(np.float16).astype(np.float32)
            tensor.CopyFrom(numpy_helper.from_array(values, tensor.name))
    observation = np.random.default_rng(5).normal(size=(50, SIZES[0])).astype(np.float32)
    actions = _run(halve_weights(network), observation)
    np.testing.assert_allclose(
        actions, _run(rounded.SerializeToString(), observation), rtol=1e-5, atol=1e-5
    )
    np.testing.assert_allclose(actions, _run(network, observation), atol=1e-2)


@pytest.mark.parametrize("length", [0, 1, 500])
def test_a_file_that_is_no_network_is_an_error(network, length):
    with pytest.raises(InputError, match=r"walk-toe-0/policy\.onnx.*no whole ONNX file"):
        halve_weights(network[:length], "walk-toe-0/policy.onnx")


def test_halving_twice_changes_nothing(network):
    assert halve_weights(halve_weights(network)) == halve_weights(network)
