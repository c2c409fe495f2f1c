"""The key of a blind trial tells each effect with what was reached and what was wanted."""

from __future__ import annotations

import json
from types import SimpleNamespace

import pytest

from hyperleg_design.validation.blind.case import Case, describe
from hyperleg_design.validation.blind.wrong import SIZES, Wrong

PLAN = SimpleNamespace(
    index=7,
    kind="compound",
    plant="rig",
    robot="arm",
    recorder=SimpleNamespace(torque="motor_torque"),
    multiples=(3.0, 5.0),
)
WRONGS = (Wrong("payload", "hand", 0.5, {"x": 0.1}), Wrong("imu_bias", "imu", 0.01, {}))


def case(plan=PLAN, **values):
    parts = {
        "logs": (),
        "references": (),
        "wrongs": WRONGS,
        "multiples": (2.9, 5.1),
        "parameters": ({"mass": 0.5}, {}),
        "also": (("hand", "wrist"), ("imu",)),
    }
    return Case(plan, "robot.xml", None, **(parts | values))


def test_each_effect_has_its_own_numbers():
    told = describe(case())
    assert json.loads(json.dumps(told)) == told  # as the key's file holds it
    assert (told["case"], told["references"], told["torque"]) == ("007", False, "motor_torque")
    first, second = told["wrongs"]
    assert (first["effect"], first["location"], first["also"]) == (
        "payload",
        "hand",
        ["hand", "wrist"],
    )
    assert (first["wanted"], first["multiple"]) == (3.0, 2.9)
    assert (first["unit"], first["parameters"]) == (SIZES["payload"].unit, {"mass": 0.5})
    assert (second["wanted"], second["unit"], second["listed"]) == (5.0, "", True)


def test_numbers_that_do_not_belong_together_are_refused():
    with pytest.raises(ValueError, match="shorter"):
        describe(case(multiples=(2.9,)))
