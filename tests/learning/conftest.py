from __future__ import annotations

import pytest

from hyperleg_design.learning.preset import Preset
from hyperleg_design.learning.preset_file import preset_from_mapping


def tiny_mapping() -> dict:
    return {
        "name": "tiny",
        "simulations": 8,
        "rollout": 4,
        "checkpoint_every": 2,
        "trial_every": 1000,
        "late": 2,
        "late_apart": 64,
        "algorithm": {"epochs": 2, "minibatches": 2},
        "network": {"hidden": [16, 8]},
        "tasks": {
            "walk": [
                {
                    "name": "first",
                    "steps": 96,
                    "assist": 1.0,
                    "assist_gone_by": 0.67,
                    "rewards": {"linear_velocity": {"width": 0.25}},
                },
                {
                    "name": "second",
                    "steps": 96,
                    "assist": 0.0,
                    "ramps": [
                        {"set": "rewards.power", "from": -1e-4, "to": -4e-4, "steps": 64},
                        {"set": "commands.turning", "from": 0, "to": 1, "steps": 96},
                    ],
                },
            ],
            "goal": [{"name": "all", "steps": 96, "assist": 1.0}],
        },
    }


@pytest.fixture(scope="session")
def tiny() -> Preset:
    return preset_from_mapping(tiny_mapping(), "tiny.yaml")
