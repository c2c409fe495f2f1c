"""Which joints, motors and leaves a biped of HyperLeg's kind has, by its toe."""

from __future__ import annotations

import pytest

from hyperleg_design.robot import transmission
from hyperleg_design.robot.design import design_from_mapping, load_design
from hyperleg_design.robot.names import JOINTS, LAYOUTS, MOTORS
from hyperleg_design.robot.parameters.hyperleg import SPRING_LEAVES


@pytest.mark.parametrize("variant", LAYOUTS)
def test_joints_and_motors_are_those_of_the_transmission(variant):
    design = load_design("hyperleg", variant=variant)
    shape = (len(design.joint_sections), len(design.actuator_sections))
    assert transmission.joint_from_motor(design).shape == shape
    assert list(design.joint_sections) == list(JOINTS[: shape[0]])
    assert list(design.actuator_sections) == list(MOTORS[: shape[1]])
    assert len(design.every_actuator) == len(MOTORS)  # the toe's motor keeps its section


@pytest.mark.parametrize("variant", LAYOUTS)
def test_a_mapping_has_the_spring_only_where_there_is_one_and_makes_the_same_robot(variant):
    design = load_design("hyperleg", variant=variant)
    mapping = design.to_mapping()
    assert (set(SPRING_LEAVES) <= set(mapping["toe"])) == (variant == "toe_passive")
    again = design_from_mapping(mapping, "again")
    assert again.variant == variant
    assert again.to_mapping() == mapping


def test_both_ankle_motors_are_one_section(hyperleg):
    left, right = (hyperleg.actuator_sections[name] for name in MOTORS if name.startswith("ankle"))
    assert left is right is hyperleg.actuators.ankle
