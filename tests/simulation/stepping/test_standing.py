from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.trees.tree_load import tree_design_from_mapping
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.model import simulation_model
from hyperleg_design.simulation.settings import Limits
from hyperleg_design.simulation.stepping.standing import check_all_standing, check_standing
from hyperleg_design.simulation.tasks import load_task


@pytest.fixture(scope="module")
def robot(design):
    task = load_task("walk")
    own = task.posed(design)
    return own, simulation_model(own, task.physics), layout_of(own), task.limits


def test_a_robot_whose_pelvis_stands_lower_than_a_fall_is_refused(robot) -> None:
    own, model, layout, limits = robot
    check_standing(model, layout, limits, own.name)
    with pytest.raises(InputError, match=r"stands lower than a fall, 2\.5 m"):
        check_standing(model, layout, Limits(height=2.5), own.name)


def test_a_robot_whose_base_is_under_its_feet_is_refused(robot) -> None:
    own, model, layout, limits = robot
    upside_down = dataclasses.replace(layout, default_height=-0.2)
    with pytest.raises(InputError, match=r"-0\.2: the pelvis is no higher than the pads"):
        check_standing(model, upside_down, limits, own.name)


def test_a_weight_beside_the_soles_is_refused(robot) -> None:
    import copy

    own, model, layout, limits = robot
    leaning = copy.deepcopy(model)
    body = leaning.body(layout.base).id
    leaning.body_ipos[body, 0] += 1.0
    with pytest.raises(InputError, match="beside the soles"):
        check_standing(leaning, layout, limits, own.name)


def test_a_batch_says_which_robots_cannot_stand(robot) -> None:
    import copy

    own, model, layout, limits = robot
    leaning = copy.deepcopy(model)
    leaning.body_ipos[leaning.body(layout.base).id, 0] -= 1.0
    with pytest.raises(InputError, match="beside the soles") as caught:
        check_all_standing([own] * 3, [model, leaning, model], [layout] * 3, limits)
    np.testing.assert_array_equal(caught.value.bad, [False, True, False])


@pytest.mark.parametrize(("offset", "stands"), [(0.0, True), (0.04, True), (-0.12, False)])
def test_on_point_feet_a_robot_may_lean_as_far_as_a_step_catches(offset, stands) -> None:
    mass = {"mass": 0.01, "gyration": [0.05, 0.05, 0.05]}
    side = {"position": [0, 0.1, 0]}
    robot = tree_design_from_mapping(
        {
            "family": "tree",
            "trunk": {"link": "body"},
            "limbs": {"left": side, "right": {"position": [0, -0.1, 0], "mirror": True}},
            "links": {"body": mass | {"mass": 5.0, "com": [offset, 0, 0]}, "leg": mass},
            "joints": {"hip": {"parent": "body", "child": "leg", "stiffness": 50}},
            "actuators": {"hip": {"motor": "RI70", "gear": 7, "housed_in": "body"}},
            "pads": {"foot": {"link": "leg", "position": [0, 0, -0.5], "radius": 0.01}},
        },
        "stilts",
        "stilts.yaml",
    )
    limits = load_task("walk_any").limits
    parts = simulation_model(robot), layout_of(robot), limits, robot.name
    if stands:
        check_standing(*parts)
    else:
        with pytest.raises(InputError, match=r"stilts: default posture = \[-0.12, 0.0\].* from \["):
            check_standing(*parts)
