from __future__ import annotations

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.robot import description
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.checks.check_urdf import check_urdf
from hyperleg_design.robot.description import expanded, tree_mapping, tree_yaml, urdf
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.load import load_robot


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


def template_text(design):
    """What xacro makes of the template for one robot."""
    tree = build_tree(design)
    return expanded(
        resources.content_folder("descriptions") / description.TEMPLATE,
        tree_mapping(tree),
        tree.name,
    )


@pytest.mark.parametrize("name", resources.names("descriptions"))
def test_a_template_that_was_expanded_before_gives_the_same_text(name):
    """To the last digit, also after another robot of the same outline."""
    design = load_robot(name)
    other = design.with_values({"contact.pad_radius": 1.25 * design.contact_section.pad_radius})
    for each in (other, design):
        assert urdf(each) == template_text(each)


@given(st.data())
@settings(max_examples=5)
def test_any_design_gives_the_text_of_the_template(random_designs, data):
    design = data.draw(random_designs)
    assert urdf(design) == template_text(design)


def test_a_template_that_somebody_changed_is_expanded_for_each_robot(
    hyperleg, tmp_path, monkeypatch
):
    template = resources.content_folder("descriptions") / description.TEMPLATE
    text = template.read_text().replace("${part['mass']}", "${2 * part['mass']}")
    (tmp_path / "mine.xacro").write_text(text)
    monkeypatch.setattr(description, "TEMPLATE", str(tmp_path / "mine.xacro"))
    mass = float(hyperleg.toe.mass)
    for factor in (1.0, 1.5):
        tree = build_tree(hyperleg.with_values({"toe.mass": factor * mass}))
        root = etree.fromstring(urdf(hyperleg, tree).encode())
        for link in tree.links:
            inertial = root.find(f"link[@name='{link.name}']/inertial/mass")
            assert inertial is None or float(inertial.get("value")) == 2 * link.mass
