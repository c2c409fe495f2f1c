import numpy as np
import pytest

pytest.importorskip("gymnasium")


def test_vector_interface(make):
    from hyperleg_design.simulation.gymnasium_vector import GymnasiumVector

    vector = GymnasiumVector(make(simulations=4))
    observations, _ = vector.reset()
    assert vector.observation_space.contains(observations)
    finals = 0
    for _ in range(80):
        observations, reward, terminated, truncated, info = vector.step(
            np.full((4, 14), 2.0, np.float32)
        )
        assert vector.observation_space.contains(observations)
        assert reward.shape == terminated.shape == truncated.shape == (4,)
        if "final_obs" in info:
            finals += 1
            np.testing.assert_array_equal(info["_final_obs"], terminated | truncated)
    assert finals
    vector.close()
