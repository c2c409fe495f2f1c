"""A policy or critic that is conditioned on its design, as an ordinary network for one design.

For one design the conditioning is constant: with the normalised numbers d of the design, the first
layer's columns of d add W_d d to its bias, and the modulation a(d) (W x + b) + s(d) of a hidden
layer (`learning/learner/modulation.py`) is a layer of weights a W and biases a b + s.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np


def fold_design(
    network: Mapping[str, Any],
    modulation: Mapping[int, tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]],
    numbers: Mapping[str, float],
) -> dict[str, Any]:
    """Fold one design into a network that observes it.

    Args:
        network: `columns` (names of its inputs, k of them of the design), `mean` and `deviation` of
            its normaliser `(size,)`, `weights` `(outputs, inputs)` and `biases` `(outputs,)` of
            each layer.
        modulation: of some hidden layers, by place: weight `(outputs, k)` and bias `(outputs,)` of
            the scale, then of the shift.
        numbers: that the design's columns have, by name, before the normaliser.

    Returns:
        The network without the design's columns and without modulation: the same outputs, to
        rounding.
    """
    columns, mean, deviation = network["columns"], network["mean"], network["deviation"]
    folded = [i for i, name in enumerate(columns) if name in numbers]
    others = [i for i, name in enumerate(columns) if name not in numbers]
    values = np.array([numbers[columns[i]] for i in folded])
    design = (values - mean[folded]) / deviation[folded]
    weights, biases = list(network["weights"]), list(network["biases"])
    biases[0] = biases[0] + weights[0][:, folded] @ design
    weights[0] = weights[0][:, others]
    for place, (scale_weight, scale_bias, shift_weight, shift_bias) in modulation.items():
        scale, shift = scale_weight @ design + scale_bias, shift_weight @ design + shift_bias
        weights[place] = scale[:, None] * weights[place]
        biases[place] = scale * biases[place] + shift
    return {
        "columns": tuple(columns[i] for i in others),
        "mean": mean[others],
        "deviation": deviation[others],
        "weights": tuple(weights),
        "biases": tuple(biases),
    }
