import pytest

from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.load import load_robot, robot_from_mapping
from hyperleg_design.simulation.symmetry import mirrored_joints, mirrored_order


def test_hyperlegs_legs_are_images_with_equal_signs():
    tree = build_tree(load_design("toe"))
    assert mirrored_joints(tree) == tuple(((i + 7) % 14, 1.0) for i in range(14))
    assert mirrored_order(tree, ["left_foot", "right_foot"]) == (1, 0)


def test_a_quadrupeds_left_legs_are_images_of_its_right_ones():
    tree = build_tree(load_robot("mini_cheetah"))
    order = [joint.name for joint in tree.moving]
    found = mirrored_joints(tree)
    assert found is not None
    for name, (place, sign) in zip(order, found, strict=True):
        swapped = name.replace("left", "x").replace("right", "left").replace("x", "right")
        assert (order[place], sign) == (swapped, 1.0)


def test_a_planar_leg_is_its_own_image():
    found = mirrored_joints(build_tree(load_robot("teaching_leg")))
    assert found == ((0, 1.0), (1, 1.0))


def arms(right_axis, default=0.0):
    """A body with a sideways joint on each side, axes given by hand as in a robot from a URDF."""
    arm = {"mass": 1.0, "gyration": [0.1, 0.1, 0.1], "com": [0.0, 0.0, -0.1]}
    joint = {"parent": "body", "lower_deg": -60, "upper_deg": 60}
    return robot_from_mapping(
        {
            "family": "tree",
            "name": "arms",
            "trunk": {"link": "body"},
            "links": {"body": {"mass": 3.0, "gyration": [0.1, 0.1, 0.1]}, "l": arm, "r": arm},
            "joints": {
                "left": {**joint, "child": "l", "axis": [1, 0, 0], "position": [0, 0.1, 0]},
                "right": {
                    **joint,
                    "child": "r",
                    "axis": right_axis,
                    "position": [0, -0.1, 0],
                    "default_deg": default,
                },
            },
            "actuators": {
                name: {"motor": "RI60", "gear": 9, "housed_in": "body"}
                for name in ("left", "right")
            },
        },
        "arms",
    )


@pytest.mark.parametrize(
    ("axis", "default", "expected"),
    [
        ([-1, 0, 0], 0, ((1, 1.0), (0, 1.0))),
        ([1, 0, 0], 0, ((1, -1.0), (0, -1.0))),
        ([0, 1, 0], 0, None),
        ([1, 0, 0], 20, None),
    ],
)
def test_equal_axes_of_the_two_sides_have_opposite_signs(axis, default, expected):
    assert mirrored_joints(build_tree(arms(axis, default))) == expected
