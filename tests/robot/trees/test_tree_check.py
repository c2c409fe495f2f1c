"""Trees that are no robots are refused with the place and the remedy."""

from __future__ import annotations

import pytest

from hyperleg_design.errors import InputError
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
            with_part("links", shank={"mass": 0.5}),
            ["links.shank.gyration", "radii of gyration"],
            id="mass without extent",
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


def test_a_link_that_cannot_contain_the_motor_taken_out_of_it_names_that_motor():
    small = {"mass": 1.0, "com": [0, 0, -0.1], "gyration": [0.01, 0.01, 0.01]}
    sections = with_part("links", thigh=small)
    with pytest.raises(InputError, match=r"links.thigh.*motor and gear of knee.*law: fixed"):
        leg(**sections).with_values({"actuators.knee.gear": 3})
    fixed = leg(**sections, masses={"law": "fixed"}).with_values({"actuators.knee.gear": 3})
    assert fixed["actuators.knee.gear"] == 3
