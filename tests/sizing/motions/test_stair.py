import numpy as np
import pytest

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing.motions.stair import StairPlan, stair


def test_starts_and_ends_at_rest_one_step_higher():
    plan = StairPlan(step_height=0.15)
    motion = stair(load_design(), plan)
    np.testing.assert_allclose(motion.v[[0, -1]], 0.0, atol=0.02)
    assert motion.q[-1, 2] - motion.q[0, 2] == pytest.approx(0.15)
    assert motion.q[-1, 0] - motion.q[0, 0] == pytest.approx(plan.step_depth, abs=0.03)
    for path in motion.feet:
        assert path.position[0, -1, 2] - path.position[0, 0, 2] == pytest.approx(0.15)


def test_never_both_feet_off_the_floor():
    motion = stair(load_design())
    assert motion.contact.any(1).all()


def test_too_high_a_step_says_why():
    with pytest.raises(InfeasibleError, match="hyperleg"):
        stair(load_design(), StairPlan(step_height=0.55))


@pytest.mark.parametrize(
    ("field", "value"), [("step_height", -0.1), ("swing", 0.0), ("pitch_off", 1.5)]
)
def test_bad_plans_name_the_field(field, value):
    with pytest.raises(InputError, match=field):
        StairPlan(**{field: value})
