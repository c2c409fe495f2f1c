import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.simulation.state import read_motion
from hyperleg_design.simulation.terms.assist import DAMPING, FORCE, TORQUE, Assist


def motion_of(roll=0.0, pitch=0.0, velocity=(0, 0, 0), turning=(0, 0, 0)):
    qpos, qvel = np.zeros((1, 21)), np.zeros((1, 20))
    qpos[0, 3:7] = np.cos(roll / 2 + pitch / 2), np.sin(roll / 2), np.sin(pitch / 2), 0
    qvel[0, :3], qvel[0, 3:6] = velocity, turning
    return read_motion(qpos, qvel)


def test_force_toward_the_commanded_velocity():
    wrench = Assist().wrench(motion_of(velocity=(0.3, 0.5, 0)), np.array([1.0]), turns=False)
    np.testing.assert_allclose(wrench, [[FORCE * 0.7, -FORCE * 0.5, 0, 0, 0, 0]])


@pytest.mark.parametrize(("roll", "pitch"), [(0.1, 0.0), (0.0, 0.1), (-0.1, 0.0), (0.0, -0.1)])
def test_torque_turns_back_upright(roll, pitch):
    wrench = Assist().wrench(motion_of(roll, pitch), np.zeros(1), turns=False)
    np.testing.assert_allclose(
        wrench[0, 3:], [-TORQUE * np.sin(roll), -TORQUE * np.sin(pitch), 0], atol=1e-9
    )


def test_torque_damps_all_turning():
    wrench = Assist().wrench(motion_of(turning=(1.0, 2.0, 3.0)), np.zeros(1), turns=False)
    np.testing.assert_allclose(wrench[0, 3:], [-DAMPING, -2 * DAMPING, -3 * DAMPING])


def test_robots_that_have_to_turn_may_do_so():
    motion = motion_of(turning=(1.0, 2.0, 3.0))
    wrench = Assist().wrench(motion, np.zeros(1), turns=True)
    np.testing.assert_allclose(wrench[0, 3:], [-DAMPING, -2 * DAMPING, 0.0])


def test_it_only_decays_and_then_is_gone():
    assist, gains = Assist(), []
    while assist.active:
        gains.append(assist.gain)
        assist.decay()
    assert np.all(np.diff(gains) < 0)
    assert assist.gain == 0.0
    assert 60 < len(gains) < 70  # 0.93^64 < 0.01
    np.testing.assert_array_equal(assist.wrench(motion_of(0.3), np.ones(1), turns=False), 0.0)


def test_gain_is_checked():
    with pytest.raises(InputError, match="gain"):
        Assist(gain=2.0)
