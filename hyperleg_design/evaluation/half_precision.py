"""Networks with weights in half precision: files of half the size, evaluated as they are stored."""

from __future__ import annotations

from typing import Any

from hyperleg_design.errors import InputError, in_short

SUFFIX = "_single"
"""Ending of the name of a weight once it is cast to single precision."""


def halve_weights(content: bytes, where: str = "policy") -> bytes:
    """Store the matrices of an ONNX network in half precision, cast to single precision where they
    are used.

    Normaliser and biases stay in single precision, and so does all arithmetic. A weight changes by
    at most 2**-11 of its value (round to nearest, IEEE 754 binary16), or by 2**-25 where it is
    smaller than 2**-14.

    Args:
        content: of the ONNX file; what is in half precision already stays as it is.
        where: name of the file, for errors.

    Returns:
        The bytes of the file with smaller weights, and the same metadata.

    Raises:
        InputError: no whole ONNX file.
    """
    import onnx
    from onnx import TensorProto, helper, numpy_helper

    try:
        model = onnx.load_from_string(content)
        onnx.checker.check_model(model)
    except Exception as error:  # protobuf's own kinds
        reason = in_short(error, 80)
        raise InputError(
            where, "", None, f"is no whole ONNX file ({reason}); export it again"
        ) from None
    graph = model.graph
    casts: list[Any] = []
    for tensor in graph.initializer:
        if tensor.data_type != TensorProto.FLOAT or len(tensor.dims) != 2 or tensor.dims[0] < 2:
            continue
        values = numpy_helper.to_array(tensor).astype("float16")
        tensor.CopyFrom(numpy_helper.from_array(values, tensor.name))
        single = tensor.name + SUFFIX
        for node in graph.node:
            node.input[:] = [single if name == tensor.name else name for name in node.input]
        casts.append(helper.make_node("Cast", [tensor.name], [single], to=TensorProto.FLOAT))
    nodes = [*casts, *graph.node]
    del graph.node[:]
    graph.node.extend(nodes)
    return bytes(model.SerializeToString(deterministic=True))
