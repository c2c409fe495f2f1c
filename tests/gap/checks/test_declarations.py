"""Metadata that nobody would read, or that name another robot's parts."""

from __future__ import annotations

from hyperleg_design.gap.checks.declarations import declarations
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
