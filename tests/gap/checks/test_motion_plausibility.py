"""Velocities against the change of positions."""

import numpy as np
import pytest
from rig import rig_log, spoiled

from hyperleg_design.gap.checks.plausibility import implausible
from hyperleg_design.gap.results.finding import ERROR
from tests.gap.checks.implausible import errors, only


def test_velocity_in_degrees_or_rpm():
    only(errors(spoiled(rig_log(), velocity__hip=np.degrees)), "velocity/hip", "deg/s")
    only(errors(spoiled(rig_log(), velocity__hip=lambda v: v * 30 / np.pi)), "velocity/hip", "rpm")


def test_position_in_degrees():
    found = errors(spoiled(rig_log(), position__hip=np.degrees))
    assert {s for s, _ in found} >= {"velocity/hip", "position_target/hip"}
    assert all("degrees" in what for _, what in found if "gains" not in what)


@pytest.mark.parametrize("kind", ["velocity", "position_target", "position"])
def test_swapped_joints(kind):
    log = rig_log()
    swapped = spoiled(
        log,
        **{
            f"{kind}__hip": log.signals[f"{kind}/knee"],
            f"{kind}__knee": log.signals[f"{kind}/hip"],
        },
    )
    found = errors(swapped)
    assert found
    assert all("swapped" in f.remedy for f in implausible(swapped) if f.severity == ERROR)


def test_flipped_signs():
    only(errors(spoiled(rig_log(), velocity__hip=np.negative)), "velocity/hip", "against the rate")
    assert ("position_target/hip", "runs against its position") in errors(
        spoiled(rig_log(), position_target__hip=np.negative)
    )
