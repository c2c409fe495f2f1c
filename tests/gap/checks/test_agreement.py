"""Several logs of one robot that contradict each other are named."""

from __future__ import annotations

import pytest
from rig import rig_log, spoiled

from hyperleg_design.gap.checks.agreement import disagreements


@pytest.fixture(scope="module")
def logs():
    return [rig_log().changed(name=f"run_{i}") for i in range(3)]


def test_logs_that_agree(logs):
    assert disagreements(logs) == {}
    assert disagreements(logs[:1]) == {}


def test_one_in_another_unit(logs):
    odd = spoiled(logs[2], motor_torque__hip=1000 * logs[2].column("motor_torque/hip"))
    found = disagreements([logs[0], logs[1], odd])
    assert list(found) == ["run_2"]
    assert found["run_2"][0].signal == "motor_torque/hip"
    assert "is 1e+03 times as large as in the other logs" in found["run_2"][0].what


def test_other_gains_and_other_joints(logs):
    other = rig_log(gains={"hip": (1.0, 0.1), "knee": (1.0, 0.1)}).changed(name="soft")
    found = disagreements([*logs, other])
    assert [f.what for f in found["soft"]] == ["declares another gains than the other logs"]
    fewer = logs[1].changed(
        signals={c: v for c, v in logs[1].signals.items() if not c.endswith("/knee")}
    )
    found = disagreements([logs[0], fewer, logs[2]])
    assert found["run_1"][0].what == "lacks joints of the other logs: knee"
