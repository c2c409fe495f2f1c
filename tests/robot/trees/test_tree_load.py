"""Bad input of a written-out tree: one clear error each."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest
import yaml

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot, robot_from_mapping
from tests.robot.tree_files import leg, leg_file

LINK = {"mass": 1.0, "gyration": [0.1, 0.1, 0.05]}


def with_part(section, **parts):
    return {section: leg_file()[section] | parts}


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        pytest.param(
            with_part("joints", back={"parent": "shank", "child": "thigh"}),
            ["joints.back.child", "thigh", "loops"],
            id="link carried twice",
        ),
        pytest.param(
            with_part("joints", hip={"parent": "shank", "child": "thigh"}),
            ["joints.hip.parent", "leads back to itself", "loops"],
            id="loop away from the root",
        ),
        pytest.param(
            with_part("joints", hip={"parent": "thigh", "child": "base"}),
            ["joints.hip.child", "root link"],
            id="root carried",
        ),
        pytest.param(
            with_part("links", spare=LINK), ["links.spare", "second root"], id="two roots"
        ),
        pytest.param(
            with_part("joints", knee={"parent": "thig", "child": "shank"}),
            ["joints.knee.parent", "thig", "did you mean thigh"],
            id="unknown link",
        ),
        pytest.param(
            {"actuators": {"hip": leg_file()["actuators"]["hip"]}},
            ["joints.knee", "no motor"],
            id="joint without a motor",
        ),
        pytest.param(
            {"transmission": {"joint_from_motor": [[7, 7], [9, 9]]}},
            ["transmission", "singular", "hip and knee cannot be driven apart"],
            id="singular matrix",
        ),
        pytest.param(
            {"transmission": {"joint_from_motor": [[7, 0, 0], [0, 9, 0]]}},
            ["transmission.joint_from_motor", "holds 2 by 3", "2 rows of 2"],
            id="wrong size",
        ),
        pytest.param(
            {"transmission": {"joint_from_motor": [[7, 0], [0]]}},
            ["transmission.joint_from_motor", "2 rows of 2"],
            id="ragged",
        ),
        pytest.param(
            {"transmission": {"joint_from_motor": [[7, 0], [0, 9]], "joints": ["hip", "hip"]}},
            ["transmission.joints", "each of hip, knee once"],
            id="repeated row",
        ),
        pytest.param(
            {"transmission": {"hip": {"kne": 1.0}}},
            ["transmission.hip.kne", "did you mean knee"],
            id="unknown joint",
        ),
        pytest.param(
            with_part("joints", knee=leg_file()["joints"]["knee"] | {"position": [0, 0, -200]}),
            ["joints.knee.position", "-200", "m", "check unit"],
            id="millimetres",
        ),
        pytest.param(
            with_part(
                "joints", knee=leg_file()["joints"]["knee"] | {"lower_deg": 2, "upper_deg": 1}
            ),
            ["joints.knee.lower_deg", "below upper_deg"],
            id="reversed range",
        ),
        pytest.param(
            with_part("joints", knee=leg_file()["joints"]["knee"] | {"axis": [1, 1, 0]}),
            ["joints.knee.axis", "length 1"],
            id="axis",
        ),
        pytest.param(
            with_part("links", shank={"mass": 1.0, "gyration": [0.1, 0.01, 0.01]}),
            ["links.shank", "no body has"],
            id="inertia",
        ),
        pytest.param(
            with_part("links", shank={"mass": 0.0}), ["links.shank.mass", "no mass"], id="massless"
        ),
        pytest.param(
            with_part("actuators", knee={"motor": "RI6O", "gear": 9, "housed_in": "thigh"}),
            ["actuators.knee.motor", "RI6O", "RI60"],
            id="motor",
        ),
        pytest.param(
            with_part("actuators", knee={"motor": "RI60", "gear": 9, "housed_in": "thig"}),
            ["actuators.knee.housed_in", "thigh"],
            id="housing",
        ),
        pytest.param(
            with_part("pads", foot={"link": "foot", "position": [0, 0, 0]}),
            ["pads.foot.link", "foot", "no such link"],
            id="pad",
        ),
        pytest.param({"feet": {}}, ["feet", "no such field"], id="unknown section"),
        pytest.param(
            with_part("links", **{"sh ank": LINK}), ["links.sh ank", "underscores"], id="name"
        ),
        pytest.param(
            {"masses": {"expected_total": 5.0}}, ["masses.expected_total", "3 kg"], id="total"
        ),
    ],
)
def test_bad_trees_are_refused_with_place_and_remedy(sections, words):
    with pytest.raises(InputError) as caught:
        leg(**sections)
    for word in ["leg.yaml", *words]:
        assert word in str(caught.value)


def test_the_three_ways_to_give_the_transmission_are_the_same():
    plain = leg(transmission={"hip": 1.0, "knee": {"knee": 1.5}})
    whole = leg(transmission={"joint_from_motor": [[7, 0], [0, 13.5]]})
    assert np.array_equal(
        transmission.joint_from_motor(plain), transmission.joint_from_motor(whole)
    )
    shared = leg(transmission={"joint_from_motor": [[7, -9], [0, 9]]})
    assert np.allclose(transmission.joint_from_motor(shared), [[7, -9], [0, 9]])
    swapped = {
        "joint_from_motor": [[9, 0], [-9, 7]],
        "joints": ["knee", "hip"],
        "motors": ["knee", "hip"],
    }
    assert np.allclose(transmission.joint_from_motor(leg(transmission=swapped)), [[7, -9], [0, 9]])


def test_the_example_of_the_page_loads(tmp_path):
    page = (Path(__file__).parents[3] / "docs" / "robots.md").read_text()
    path = tmp_path / "mine.yaml"
    path.write_text(page.split("```yaml\n")[1].split("```")[0])
    assert transmission.joint_names(load_robot(path)) == ("hip", "knee")


def test_joints_come_parents_first_whatever_the_file_says():
    joints = leg_file()["joints"]
    turned = leg(joints={"knee": joints["knee"], "hip": joints["hip"]})
    assert transmission.joint_names(turned) == ("hip", "knee")


def test_values_are_replaced_checked_and_remembered():
    design = leg().with_values({"joints.knee.coulomb": 0.4})
    assert design["joints.knee.coulomb"] == 0.4
    assert design.origins["joints.knee.coulomb"].label == "user"
    with pytest.raises(InputError, match=r"leg\.yaml with override.*joints\.knee\.default_deg"):
        design.with_values({"joints.knee.upper_deg": -170.0})
    with pytest.raises(InputError, match=r"did you mean joints\.knee\.coulomb"):
        design.with_values({"joints.knee.coulom": 1.0})


def test_a_replaced_mass_lets_the_published_total_lapse():
    design = load_robot("mini_cheetah", overrides=["links.shank.mass=0.1"])
    assert design["masses.expected_total"] == 0


def test_a_file_may_build_on_another(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("base: mini_cheetah\nactuators: {knee: {gear: 8}}\n")
    design = load_robot(path)
    assert (design.name, design["actuators.knee.gear"]) == ("mine", 8.0)
    path.write_text(yaml.safe_dump({"family": "octopus"}))
    with pytest.raises(InputError, match=r"family.*octopus.*hyperleg, tree"):
        load_robot(path)
    with pytest.raises(InputError, match="no variants"):
        load_robot("mini_cheetah", variant="toe_locked")


def test_designs_travel_to_other_processes_and_back_from_mappings():
    design = leg().with_values({"links.shank.mass": np.array([1.0, 2.0])})
    again = pickle.loads(pickle.dumps(design))
    assert np.array_equal(again["links.shank.mass"], [1.0, 2.0])
    assert again.origins == design.origins
    one = design.take(1)
    assert robot_from_mapping(one.to_mapping(), "here").to_mapping() == one.to_mapping()


def test_what_needs_hyperleg_refuses_another_family_and_says_so():
    with pytest.raises(InputError, match=r"mini_cheetah\.yaml.*family.*another family.*load_robot"):
        load_design("mini_cheetah")
