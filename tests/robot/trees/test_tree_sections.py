"""Sections of a design that writes its tree out: what their numbers mean, and which are refused."""

from __future__ import annotations

import numpy as np
import pinocchio
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.trees import tree_sections
from hyperleg_design.robot.trees.limb_masses import limb_masses
from hyperleg_design.robot.trees.tree_limb import turned
from tests.robot.tree_files import leg, leg_file


def link(name, **changes):
    """A leg whose one link is changed."""
    links = leg_file()["links"]
    return leg(links=links | {name: links[name] | changes})


def test_gyration_and_inertia_of_a_link_add_up():
    gyration, stated = [0.2, 0.3, 0.3], [0.01, 0.02, 0.03, 0.001, 0.002, 0.003]
    body = limb_masses(link("shank", mass=2.0, gyration=gyration, inertia=stated)).links["shank"]
    expected = np.diag([2 * 0.04 + 0.01, 2 * 0.09 + 0.02, 2 * 0.09 + 0.03])
    expected += np.array([[0, 0.001, 0.002], [0.001, 0, 0.003], [0.002, 0.003, 0]])
    np.testing.assert_allclose(body.inertia, expected)


def test_roll_pitch_and_yaw_of_a_joint_are_those_of_urdf():
    """Pinocchio's roll, pitch and yaw, which follow URDF."""
    degrees = [20.0, -35.0, 70.0]
    np.testing.assert_allclose(turned(degrees), pinocchio.rpy.rpyToMatrix(*np.deg2rad(degrees)))
    joints = leg_file()["joints"]
    design = leg(joints=joints | {"knee": joints["knee"] | {"turn_deg": degrees}})
    knee = next(joint for joint in build_tree(design).joints if joint.child == "shank")
    np.testing.assert_allclose(knee.turn, np.deg2rad(degrees))


@pytest.mark.parametrize(("stated", "radius"), [(0.0, 0.013), (0.02, 0.02)])
def test_a_pad_without_radius_has_that_of_the_contact(stated, radius):
    pads = {"foot": {"link": "shank", "position": [0, 0, -0.2], "radius": stated}}
    design = leg(pads=pads).with_values({"contact.pad_radius": 0.013})
    (pad,) = next(part for part in build_tree(design).links if part.name == "shank").pads
    assert pad.size == (pytest.approx(radius),)


@pytest.mark.parametrize(
    ("section", "leaves", "words"),
    [
        ("Trunk", {"link": "base", "motion": "flying"}, "trunk: motion.*floating, fixed"),
        ("LimbCopy", {"mirror": "y"}, "limbcopy: mirror"),
        ("LinkSection", {"mass": -1}, "linksection: mass.*-1.*kg"),
        ("LinkSection", {"mass": 1, "com": [0, 0]}, "com.*3"),
        ("LinkSection", {"mass": 1, "inertia": [1, 1, 1]}, "inertia.*6"),
        ("TreeJointSection", {"parent": "a", "child": "b", "axis": [0, 2, 0]}, "axis"),
        ("TreeJointSection", {"parent": "a", "child": "b", "derate": 0}, "derate"),
        ("TreeActuator", {"motor": "RI70", "gear": 0.1, "housed_in": "a"}, "gear"),
        ("PadSection", {"link": "a", "position": [0, 0, 0], "radius": 40}, "radius.*40.*m"),
        ("TreeMassModel", {"law": "guessed"}, "law.*components, fixed"),
    ],
)
def test_what_no_tree_has_is_refused(section, leaves, words):
    with pytest.raises(InputError, match=words):
        getattr(tree_sections, section)(**leaves)
