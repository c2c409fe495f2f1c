import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.simulation.commands import VelocityCommands, changed_commands, commander
from hyperleg_design.simulation.state import read_motion


def at(places, yaw=0.0):
    places = np.atleast_2d(places)
    qpos = np.zeros((len(places), 21))
    qpos[:, :2], qpos[:, 3], qpos[:, 6] = places, np.cos(yaw / 2), np.sin(yaw / 2)
    return read_motion(qpos, np.zeros((len(places), 20)))


def test_velocity_commands_keep_their_ranges_and_shares():
    settings = VelocityCommands(
        forward_low=0.2,
        forward_high=1.0,
        sideways=0.3,
        turning=0.5,
        test_share=0.4,
        standing_share=0.1,
    )
    keeper, rng = commander(settings, 5000), np.random.default_rng(0)
    keeper.reset(np.arange(5000), at(np.zeros((5000, 2))), rng)
    values = keeper.vector(None)
    test, still = np.all(values == [1.33, 0, 0], 1), np.all(values == 0, 1)
    assert test.mean() == pytest.approx(0.4, abs=0.03)
    assert still.mean() == pytest.approx(0.1, abs=0.02)
    rest = values[~test & ~still]
    assert np.all((rest >= [0.2, -0.3, -0.5]) & (rest <= [1.0, 0.3, 0.5]))
    assert np.ptp(rest, 0) == pytest.approx([0.8, 0.6, 1.0], rel=0.05)


def test_velocity_commands_change_after_their_interval():
    keeper, rng = (
        commander(VelocityCommands(interval=0.1, test_share=0.0), 3),
        np.random.default_rng(0),
    )
    motion = at(np.zeros((3, 2)))
    keeper.reset(np.arange(3), motion, rng)
    first = keeper.vector(None)
    for _ in range(4):
        keeper.advance(motion, None, 0.02, rng)
    np.testing.assert_array_equal(keeper.vector(None), first)
    keeper.advance(motion, None, 0.02, rng)
    assert np.all(keeper.vector(None)[:, 0] != first[:, 0])


def test_changed_commands_are_validated_and_name_the_task():
    settings = VelocityCommands(turning=0.5)
    changed = changed_commands(settings, {"sideways": 0.25}, "task walk")
    assert (changed.sideways, changed.turning, settings.sideways) == (
        0.25,
        0.5,
        VelocityCommands().sideways,
    )
    with pytest.raises(InputError, match=r"task walk.*commands\.sidewise.*no such setting"):
        changed_commands(settings, {"sidewise": 0.25}, "task walk")
    with pytest.raises(InputError, match="test_share"):
        changed_commands(settings, {"test_share": 2.0}, "task walk")
