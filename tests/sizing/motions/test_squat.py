import numpy as np
import pytest

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing.motions.squat import SquatPlan, sole_middle, squat


def test_goes_down_by_its_depth_on_symmetric_legs():
    motion = squat(load_design(), SquatPlan(depth=0.1))
    assert np.ptp(motion.q[:, 2]) == pytest.approx(0.1, rel=1e-3)
    np.testing.assert_allclose(motion.joint_position[:, 0], motion.joint_position[:, 1], atol=1e-9)
    assert motion.contact.all()


def test_slow_squat_keeps_the_mass_over_the_pressure():
    motion = squat(load_design(), SquatPlan(depth=0.1, period=60.0))
    centers = np.array([motion.model.center_of_mass(q) for q in motion.q])
    np.testing.assert_allclose(centers[:, 0], sole_middle(motion.model.design), atol=3e-3)


def test_too_deep_names_the_joint():
    with pytest.raises(InfeasibleError, match="ankle_pitch would have to turn"):
        squat(load_design(), SquatPlan(depth=0.4))


def test_bad_plan():
    with pytest.raises(InputError, match="depth"):
        SquatPlan(depth=0.0)
