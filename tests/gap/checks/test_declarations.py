"""Metadata that nobody would read, or that name another robot's parts."""

from __future__ import annotations

import numpy as np
from rig import rig_log

from hyperleg_design.gap.checks.declarations import declarations, undeclared_supply
from hyperleg_design.gap.logs.metadata import Metadata, metadata_from_mapping
from hyperleg_design.gap.results.finding import ERROR, WARNING
from tests.gap.checks.implausible import Robot


class Known(Robot):
    unlogged = ("ankle",)


def test_parts_that_the_robot_has_are_fine():
    metadata = Metadata(
        gains={"hip": (20.0, 1.0), "ankle": (5.0, 0.1)},
        torque_constant={"knee": 0.1},
        supply={"hip": (24.0, 3.0, 100.0)},
    )
    assert declarations(metadata, Known()) == []


def test_a_misspelt_part_is_an_error_with_the_nearest_name():
    metadata = Metadata(gains={"kne": (20.0, 1.0)}, torque_constant={"motor_9": 0.1})
    one, other = declarations(metadata, Known())
    assert (one.severity, one.remedy) == (ERROR, "did you mean knee?")
    assert "gains of kne" in one.what
    assert other.remedy == "there are ankle, hip, knee"
    assert declarations(metadata, None) == []


def test_a_field_that_is_nearly_known_is_a_warning_and_one_of_somebody_elses_is_none():
    found = metadata_from_mapping({"gain": {"hip": [20, 1]}, "firmware": "1.2"}, "log.json")
    (one,) = declarations(found, None)
    assert (one.severity, one.remedy) == (WARNING, "did you mean gains?")


def test_a_battery_that_sags_under_servos_asks_for_their_supply():
    log = rig_log()
    silent = {c: v for c, v in log.signals.items() if not c.startswith("motor_")}
    flat, sagging = (
        log.changed(
            signals=silent | {"battery_voltage": np.linspace(7.4, low, len(log.time))},
        )
        for low in (7.3, 6.2)
    )
    assert undeclared_supply(flat) == []
    (one,) = undeclared_supply(sagging)
    assert (one.severity, one.signal) == (WARNING, "battery_voltage")
    assert "no supply is declared" in one.what
    told = sagging.metadata.changed(supply={"hip": (7.4, 1.8, 6.0)})
    assert undeclared_supply(sagging.changed(metadata=told)) == []
    measured = log.changed(signals=log.signals | dict(sagging.signals))
    assert measured.has("motor_torque", measured.motors[0]) or measured.has(
        "motor_current", measured.motors[0]
    )
    assert undeclared_supply(measured) == []
