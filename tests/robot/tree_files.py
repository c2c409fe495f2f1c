"""A small design that writes its tree out, for tests to break."""

from __future__ import annotations

import copy
from typing import Any

from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.robot.trees.tree_load import tree_design_from_mapping

SHIPPED = ("mini_cheetah", "parallel_ankle", "teaching_leg")
"""Robots in `descriptions/` that write their tree out."""

_LINK = {"mass": 1.0, "com": [0, 0, -0.1], "gyration": [0.1, 0.1, 0.05]}
_LEG: dict[str, Any] = {
    "family": "tree",
    "name": "leg",
    "trunk": {"link": "base", "motion": "fixed", "height": 0.5},
    "links": {"base": dict(_LINK), "thigh": dict(_LINK), "shank": dict(_LINK)},
    "joints": {
        "hip": {"parent": "base", "child": "thigh"},
        "knee": {"parent": "thigh", "child": "shank", "position": [0, 0, -0.2]},
    },
    "actuators": {
        "hip": {"motor": "RI70", "gear": 7, "housed_in": "base"},
        "knee": {"motor": "RI60", "gear": 9, "housed_in": "thigh"},
    },
    "pads": {"foot": {"link": "shank", "position": [0, 0, -0.2], "radius": 0.02}},
}


def leg_file(**sections: Any) -> dict[str, Any]:
    """What a file of a leg of two joints holds, with sections replaced."""
    return copy.deepcopy(_LEG) | sections


def bolted_file() -> dict[str, Any]:
    """A leg whose trunk of 5 kg is fixed to an empty root, and carries a camera of 0.1 kg."""
    whole = leg_file()
    empty, zero = {"mass": 1e-6, "gyration": [0.01] * 3}, {"type": "fixed"}
    links = {"root": empty, **whole["links"], "camera": {"mass": 0.1, "gyration": [0.02] * 3}}
    links["base"]["mass"] = 5.0
    joints = {"bolt": {"parent": "root", "child": "base", **zero}, **whole["joints"]}
    joints["mount"] = {"parent": "base", "child": "camera", **zero}
    trunk = {"link": "root", "motion": "floating"}
    return whole | {"trunk": trunk, "links": links, "joints": joints}


def leg(**sections: Any) -> TreeDesign:
    """A leg of two joints on a stand."""
    return tree_design_from_mapping(leg_file(**sections), "leg", "leg.yaml")
