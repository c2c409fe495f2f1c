import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.simulation.rollout import rollout
from hyperleg_design.simulation.terms.assist import Assist


def swinging(observations):
    return 0.3 * np.tanh(observations[:, :14]).astype(float)


def test_recording_is_deterministic_and_whole(make):
    one, other = (rollout(make(simulations=3, seed=2), swinging, 12) for _ in range(2))
    assert one.substeps == 8
    assert one.time_step == 0.0025
    assert one.commands.shape == (3, 12, 3)
    for name, values in one.signals.items():
        assert values.shape[:2] == (3, 96)
        assert values.tobytes() == other.signals[name].tobytes()
    # joint velocity is the rate of joint position
    rate = np.diff(one.signals["joint_position"], axis=1) / one.time_step
    np.testing.assert_allclose(rate, one.signals["joint_velocity"][:, 1:], atol=1e-8)


def test_first_end_is_where_the_first_episode_ends(make):
    found = rollout(
        make(simulations=4), lambda observations: np.full((4, 14), 2.0), 120, keep=["base_position"]
    )
    assert list(found.signals) == ["base_position"]
    for simulation, end in enumerate(found.first_end):
        assert found.ending[simulation, end] != 0
        assert not found.ending[simulation, :end].any()


def test_it_can_be_stopped(make):
    found = rollout(
        make(simulations=2),
        lambda o: np.zeros((2, 14)),
        50,
        each_step=lambda number, ending: number == 4,
    )
    assert found.ending.shape == (2, 5)
    assert list(found.first_end) == [5, 5]


def test_no_assist_no_unknown_signals_no_nan(make):
    with pytest.raises(InputError, match="assist"):
        rollout(make(assist=Assist()), swinging, 1)
    with pytest.raises(InputError, match="no such signal"):
        rollout(make(), swinging, 1, keep=["colour"])
    with pytest.raises(InputError, match="not finite"):
        rollout(make(), lambda o: np.full((4, 14), np.nan), 1)
