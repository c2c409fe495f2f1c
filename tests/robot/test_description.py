from __future__ import annotations

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from hyperleg_design.errors import InputError
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.check_urdf import check_urdf
from hyperleg_design.robot.description import tree_mapping, tree_yaml, urdf
from hyperleg_design.robot.tree import build_tree


def numbers(element, key: str) -> list[float]:
    return [float(v) for v in element.get(key).split()]


@given(st.data())
@settings(max_examples=5)
def test_urdf_holds_the_tree_bit_for_bit(random_designs, data):
    design = data.draw(random_designs)
    tree = build_tree(design)
    root = etree.fromstring(urdf(design, tree).encode())
    for link in tree.links:
        element = root.find(f"link[@name='{link.name}']")
        inertial = element.find("inertial")
        assert (inertial is None) == (link.mass == 0)
        if inertial is not None:
            assert float(inertial.find("mass").get("value")) == link.mass
            assert numbers(inertial.find("origin"), "xyz") == link.com.tolist()
            i = inertial.find("inertia")
            assert [
                float(i.get(k)) for k in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
            ] == link.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist()
        assert len(element.findall("collision")) == len(link.pads)
        assert len(element.findall("visual")) == len(link.visuals)
    for joint in tree.joints:
        element = root.find(f"joint[@name='{joint.name}']")
        assert element.get("type") == ("fixed" if joint.fixed else "revolute")
        assert (element.find("parent").get("link"), element.find("child").get("link")) == (
            joint.parent,
            joint.child,
        )
        if not joint.fixed:
            assert tuple(numbers(element.find("axis"), "xyz")) == joint.axis
            limit = element.find("limit")
            assert [float(limit.get(k)) for k in ("lower", "upper", "effort", "velocity")] == [
                joint.lower,
                joint.upper,
                joint.effort,
                joint.velocity,
            ]


def test_the_name_is_the_designs(hyperleg):
    assert etree.fromstring(urdf(hyperleg).encode()).get("name") == "hyperleg"


def test_tree_yaml_keeps_every_bit(hyperleg):
    tree = build_tree(
        hyperleg.with_values({"toe.gyration": [1e-3, 1.1e-3, 1.2e-3], "toe.mass": 1 / 3})
    )  # numbers like 3.3e-07
    assert yaml.safe_load(tree_yaml(tree)) == tree_mapping(tree)


@pytest.mark.parametrize("variant", ["toe", "toe_locked", "toe_removed_matched", "toe_removed"])
def test_yourdfpy_loads_what_we_write(hyperleg, variant, tmp_path):
    import yourdfpy

    path = tmp_path / "robot.urdf"
    path.write_text(urdf(variants(hyperleg)[variant]))
    robot = yourdfpy.URDF.load(str(path))
    assert robot.validate()
    assert robot.num_actuated_joints == (14 if variant == "toe" else 12)
    assert robot.base_link == "pelvis"
    foot = robot.get_transform("left_foot", "pelvis")
    np.testing.assert_allclose(foot[:3, 3], [0, 0.1, -0.715], atol=1e-12)
    assert check_urdf(path) == []


def test_a_batch_has_no_urdf(hyperleg):
    with pytest.raises(InputError, match="batch"):
        urdf(hyperleg.with_values({"toe.mass": np.array([0.2, 0.3])}))
