from __future__ import annotations

from hyperleg_design.robot import names
from hyperleg_design.robot.mass.inertials import LEG_LINKS
from hyperleg_design.robot.parameters.fields import section_types
from hyperleg_design.robot.parameters.reference_sections import Places
from hyperleg_design.robot.parameters.sections import Actuators, Joints, Transmission


def test_names_are_those_of_the_sections():
    assert tuple(section_types(Joints)) == names.JOINTS
    assert (
        tuple(section_types(Actuators))
        == tuple(dict.fromkeys(names.ACTUATOR_OF_MOTOR))
        == tuple(section_types(Places))
    )
    assert set(names.POSTURES) <= set(section_types(Transmission))
    assert (
        len(names.JOINTS)
        == len(names.MOTORS)
        == len(names.ACTUATOR_OF_MOTOR)
        == len(LEG_LINKS)
        == 7
    )
