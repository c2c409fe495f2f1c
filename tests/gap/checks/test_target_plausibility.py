"""Targets against positions, and against the torques that answer them."""

from dataclasses import replace

import numpy as np
from rig import rig_log, spoiled

from hyperleg_design.gap.checks.plausibility import implausible
from hyperleg_design.gap.results.finding import WARNING
from tests.gap.checks.implausible import errors


def test_a_load_may_push_a_joint_against_its_target():
    log = rig_log()
    names = [
        f"{kind}__hip"
        for kind in ("joint_torque", "motor_torque", "motor_torque_command", "motor_current")
        if log.has(kind, "hip")
    ]
    silent = spoiled(
        log,
        position_target__hip=np.negative,
        **{name: lambda v: np.full_like(v, np.nan) for name in names},
    )
    assert ("position_target/hip", "runs against its position") in errors(silent)
    walked = silent.changed(metadata=replace(silent.metadata, base="floating"))
    assert {f.severity for f in implausible(walked) if f.what == "runs against its position"} == {
        WARNING
    }
    stiffness, damping = log.metadata.gains["hip"]
    asked = stiffness * (
        -log.column("position_target/hip") - log.column("position/hip")
    ) - damping * log.column("velocity/hip")
    followed = spoiled(log, position_target__hip=np.negative, motor_torque__hip=lambda _: asked)
    assert not [f for f in implausible(followed) if f.what == "runs against its position"]
