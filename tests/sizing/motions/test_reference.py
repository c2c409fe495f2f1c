import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing.motions.reference import reference_motion
from hyperleg_design.sizing.motions.walk import WalkPlan


def test_plan_fields_reach_the_planner():
    assert reference_motion(load_design(), "walk", samples=41, speed=1.0).distance == pytest.approx(
        1.0 * 2 * WalkPlan().step_time
    )


def test_unknown_motion_and_field():
    with pytest.raises(InputError, match="walk, stair, squat, hop"):
        reference_motion(load_design(), "dance")
    with pytest.raises(InputError, match=r"sped.*speed"):
        reference_motion(load_design(), "walk", sped=1.0)


def test_a_batch_is_refused():
    with pytest.raises(InputError, match="batch"):
        reference_motion(load_design().with_values({"toe.mass": np.array([0.2, 0.3])}), "walk")
