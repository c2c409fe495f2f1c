"""A recommended experiment in numbers, as `plan.json` holds it."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from hyperleg_design.gap.experiments import information as info
from hyperleg_design.gap.experiments.designed_experiment import (
    CLEAR,
    Experiment,
    hidden,
    inseparable,
)
from hyperleg_design.gap.experiments.information import Blocks
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
            deviations = info.standard_deviations(gram, blocks, place, subject)
            effects.setdefault(place[0], {})[place[1]] = {
                "stands_out": _number(info.strength(gram, blocks, place)),
                "standard_deviation": {name: _number(v) for name, v in deviations.items()},
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
        "start_posture": dict(zip(subject.joints, experiment.room.centre.tolist(), strict=True)),
        "motions": [
            {
                "name": m.name,
                "purpose": m.purpose,
                "duration": m.duration,
                "scale": m.scale,
                "drives_off": float(m.off.sum() / experiment.rate),
                "use": asdict(m.use),
                "shows": sorted(
                    {p[0] for p in blocks.places if experiment.shown(p, [m.name]) >= CLEAR}
                ),
                "tells_apart": [_pair(p, grams[m.name], blocks) for p in experiment.pairs],
                "effects": effects_of(grams[m.name]),
            }
            for m in experiment.motions
        ],
        "left_out": [asdict(motion) for motion in experiment.left_out],
        "shortest_set": {
            "motions": list(experiment.chosen),
            "duration": float(sum(experiment.motion(n).duration for n in experiment.chosen)),
            "effects": effects_of(chosen),
            "tells_apart": [_pair(pair, chosen, blocks) for pair in experiment.pairs],
        },
        "inseparable": [_pair(p, experiment.gram(), blocks) for p in inseparable(experiment)],
        "not_shown": [
            {"effect": effect, "location": location} for effect, location in hidden(experiment)
        ],
        "notes": list(experiment.notes),
    }


def _pair(pair: Pair, gram: np.ndarray, blocks: Blocks) -> dict[str, Any]:
    angle = np.degrees(info.principal_angle(gram, blocks, pair.first, pair.second))
    return {
        "joint": pair.joint,
        "first": list(pair.first),
        "second": list(pair.second),
        "separated_by": pair.by,
        "apart": _number(apart(gram, blocks, pair)),
        "principal_angle": _number(float(angle)),
    }


def _number(value: float) -> float | None:
    return float(f"{value:.4g}") if np.isfinite(value) else None
