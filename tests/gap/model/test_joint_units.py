"""Units at slides and hinges, against the products that they must make."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.logs.columns import JOINT_SIGNALS, MOTOR_SIGNALS, UNITS
from hyperleg_design.gap.model.joint_units import SLIDING, joint_unit, slides, unit_at

SUBJECT = SimpleNamespace(
    joints=("rail", "tilt", "lift"),
    motors=("rail", "left", "right", "idle"),
    tree=SimpleNamespace(hinge=np.array([False, True, False])),
    joint_from_motor=np.array([[1.0, 0, 0.5, 0], [0, 1.0, 0, 0], [0, 1.0, -0.5, 0]]),
)


def dimensions(unit: str) -> tuple[int, int, int]:
    """Powers of metre, kilogram and second; an angle has none."""
    parts = {
        "rad": (0, 0, 0),
        "m": (1, 0, 0),
        "s": (0, 0, 1),
        "N": (1, 1, -2),
        "Nm": (2, 1, -2),
        "Nms": (2, 1, -1),
        "Ns": (1, 1, -1),
        "kg": (0, 1, 0),
        "m^2": (2, 0, 0),
        "1": (0, 0, 0),
    }
    above, _, below = unit.partition("/")
    power = np.sum([parts[part] for part in above.split()], 0)
    return tuple(power - parts[below] if below else power)


@pytest.mark.parametrize(("turning", "sliding"), SLIDING.items())
def test_a_slide_trades_each_angle_for_a_length_and_each_torque_for_a_force(turning, sliding):
    """What is per angle becomes per length, and a torque over its angle is the force's length."""
    angles = turning.partition("/")[0].split().count("rad") - turning.partition("/")[2].count("rad")
    torques = turning.partition("/")[0].count("Nm") - turning.partition("/")[2].count("Nm")
    inertias = turning.count("kg m^2")
    lengths = dimensions(sliding)[0] - dimensions(turning)[0]
    assert lengths == angles - torques - 2 * inertias
    assert dimensions(sliding)[1:] == dimensions(turning)[1:]


def test_units_of_both_kinds_of_joints_stay():
    assert [joint_unit(unit, True) for unit in ("s", "", "kg", "A")] == ["s", "", "kg", "A"]
    assert joint_unit("Nm", False) == "Nm"


def test_joints_slide_by_the_tree_and_motors_by_what_they_move():
    joints = [slides(SUBJECT, "joint", name) for name in SUBJECT.joints]
    motors = [slides(SUBJECT, "motor", name) for name in SUBJECT.motors]
    assert joints == [True, False, True]
    assert motors == [True, False, True, False]
    assert not slides(SUBJECT, "link", "rail")
    assert not slides(SUBJECT, "robot", "robot")


def test_a_place_has_the_unit_of_its_joint():
    assert unit_at(SUBJECT, "joint", "lift", "Nms/rad") == "Ns/m"
    assert unit_at(SUBJECT, "joint", "tilt", "Nms/rad") == "Nms/rad"
    assert unit_at(SUBJECT, "link", "rail", "kg m^2") == "kg m^2"


def test_every_unit_of_joints_that_holds_an_angle_or_a_torque_is_known():
    of_effects = {
        parameter.unit
        for effect in WEIGHED.values()
        if effect.kind in ("joint", "motor")
        for parameter in effect.parameters
    }
    of_logs = {UNITS[signal] for signal in (*JOINT_SIGNALS, *MOTOR_SIGNALS)}
    angular = {unit for unit in of_effects | of_logs if "rad" in unit or "Nm" in unit}
    assert angular <= set(SLIDING)
