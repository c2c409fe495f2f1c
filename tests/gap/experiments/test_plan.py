"""The plan of an experiment in numbers."""

from __future__ import annotations

import json


def test_plan_says_what_each_motion_tells(made):
    plan = json.loads((made.out / "plan.json").read_text())
    assert plan["schema"] == 1
    by_name = {m["name"]: m for m in plan["motions"]}
    assert "command_delay" in by_name["chirp"]["shows"]
    assert "command_delay" not in by_name["ramps"]["shows"]
    assert "coulomb_friction" in by_name["ramps"]["shows"]
    coulomb = by_name["ramps"]["effects"]["coulomb_friction"]["swing"]["standard_deviation"][
        "torque"
    ]
    assert 0 < coulomb < 0.05
    assert any("not checked" in note for note in plan["notes"])
    assert all(m["use"]["envelope"] <= 0.8 + 1e-9 for m in plan["motions"])
    assert plan["start_posture"].keys() == {"swing"}
