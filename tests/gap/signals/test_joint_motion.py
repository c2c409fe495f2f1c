import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.signals.joint_motion import joint_motion
from hyperleg_design.gap.signals.loading import load_subject

TIME = np.arange(0.0, 4.0, 0.01)


def log(**positions):
    return Log("swings", TIME, {f"position/{k}": v for k, v in positions.items()}, Metadata())


@pytest.fixture(scope="module")
def leg():
    return load_subject("teaching_leg")


def test_motion_has_the_derivatives_of_what_was_logged(leg):
    motion = joint_motion(log(hip=np.sin(TIME), knee=0.5 + 0 * TIME), leg, TIME)
    inside = slice(100, 300)
    np.testing.assert_allclose(motion.smooth.first[inside, 0], np.cos(TIME)[inside], atol=0.02)
    assert not motion.lacking.any()


def test_a_joint_without_positions_stands_still_where_the_model_has_it(leg):
    motion = joint_motion(log(hip=np.sin(TIME)), leg, TIME)
    assert motion.lacking.tolist() == [False, True]
    assert (motion.smooth.value[:, 1] == leg.default[1]).all()
    assert not motion.smooth.first[:, 1].any()
    assert "knee" in motion.notes[-1]


def test_no_joint_of_the_robot_is_an_error(leg):
    with pytest.raises(InputError, match="knows no joint"):
        joint_motion(log(wheel=np.sin(TIME)), leg, TIME)
