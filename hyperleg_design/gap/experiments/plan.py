"""A recommended experiment in numbers, as `plan.json` holds it."""

from __future__ import annotations

from typing import Any

import numpy as np

from hyperleg_design.gap.experiments import information as info
from hyperleg_design.gap.experiments.designed_experiment import (
    CLEAR,
    Experiment,
    hidden,
    inseparable,
)
from hyperleg_design.gap.experiments.pair import Pair, apart


def plan_mapping(experiment: Experiment) -> dict[str, Any]:
    """Write the plan as JSON holds it.

    Args:
        experiment: the plan.

    Returns:
        Nested mappings.
    """
    subject, blocks = experiment.subject, experiment.blocks
    chosen = experiment.gram(experiment.chosen)
    grams = {m.name: experiment.grams[m.name] for m in experiment.motions}

    def effects_of(gram: np.ndarray) -> dict[str, Any]:
        effects: dict[str, Any] = {}
        for place in blocks.places:
            deviations = {
                k: _number(v)
                for k, v in info.standard_deviations(gram, blocks, place, subject).items()
            }
            clear = info.strength(gram, blocks, place)
            effects.setdefault(place[0], {})[place[1]] = {
                "stands_out": _number(clear),
                "standard_deviation": deviations,
            }
        return effects

    return {
        "schema": 1,
        "robot": subject.path,
        "base": "fixed",
        "rate": experiment.rate,
        "noise": {
            "share_of_strength": experiment.noise,
            "correlation_time": info.NOISE_TIME,
            "torque_measured": experiment.torque,
        },
        "clear_from": CLEAR,
        "start_posture": dict(
            zip(subject.joints, (float(v) for v in experiment.room.centre), strict=True)
        ),
        "motions": [
            {
                "name": m.name,
                "purpose": m.purpose,
                "duration": m.duration,
                "scale": m.scale,
                "drives_off": float(m.off.sum() / experiment.rate),
                "use": {
                    "range": m.use.range,
                    "speed": m.use.speed,
                    "envelope": m.use.envelope,
                    "continuous": m.use.continuous,
                    "worst": m.use.worst,
                },
                "shows": sorted(
                    {
                        place[0]
                        for place in blocks.places
                        if info.strength(grams[m.name], blocks, place) >= CLEAR
                    }
                ),
                "tells_apart": _pairs_told(grams[m.name], experiment),
                "effects": effects_of(grams[m.name]),
            }
            for m in experiment.motions
        ],
        "left_out": [{"name": one.name, "why": one.why} for one in experiment.left_out],
        "shortest_set": {
            "motions": list(experiment.chosen),
            "duration": float(sum(experiment.motion(n).duration for n in experiment.chosen)),
            "effects": effects_of(chosen),
            "tells_apart": _pairs_told(chosen, experiment),
        },
        "inseparable": [
            _pair(pair, experiment.gram(), experiment) for pair in inseparable(experiment)
        ],
        "not_shown": [
            {"effect": effect, "location": location} for effect, location in hidden(experiment)
        ],
        "notes": list(experiment.notes),
    }


def _pairs_told(gram: np.ndarray, experiment: Experiment) -> list[dict[str, Any]]:
    return [_pair(pair, gram, experiment) for pair in experiment.pairs]


def _pair(pair: Pair, gram: np.ndarray, experiment: Experiment) -> dict[str, Any]:
    blocks = experiment.blocks
    return {
        "joint": pair.joint,
        "first": list(pair.first),
        "second": list(pair.second),
        "separated_by": pair.by,
        "apart": _number(apart(gram, blocks, pair)),
        "principal_angle": _number(
            float(np.degrees(info.principal_angle(gram, blocks, pair.first, pair.second)))
        ),
    }


def _number(value: float) -> float | None:
    return float(f"{value:.4g}") if np.isfinite(value) else None
