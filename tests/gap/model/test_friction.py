"""The nominal friction of joints."""

import numpy as np
import pytest

from hyperleg_design.gap.model.friction import sliding_share, stop, turned


def test_friction_over_a_swing_is_that_of_dither():
    speed = np.linspace(-2, 2, 41)
    share = sliding_share(speed, 1e-3, np.ones(41))
    assert np.allclose(share, 2 / np.pi * np.arcsin(np.clip(speed, -1, 1)), atol=0.07)
    assert np.allclose(sliding_share(speed, 0.1, np.zeros(41)), np.tanh(speed / 0.1))


def test_friction_of_the_model_is_averaged_only_where_a_joint_swings():
    speed, swing = np.array([0.2, 0.2]), np.array([0.0, 1.0])
    assert turned(speed, 0.01, swing) == pytest.approx([1.0, 2 / np.pi * np.arcsin(0.2)], abs=0.05)
    assert np.array_equal(turned(speed, 0.01), turned(speed, 0.01, np.zeros(2)))


def test_the_stop_operator_stays_between_its_ends_and_turns_over_on_its_way():
    way = 0.01
    position = np.concatenate([np.linspace(0, 0.1, 200), np.linspace(0.1, 0.0, 200)])
    found = stop(position, way)
    assert np.abs(found).max() <= 1
    assert found[150] == 1
    turned = position[200 + np.argmax(found[200:] <= -1 + 1e-9)]
    assert turned == pytest.approx(0.1 - 2 * way, abs=2e-3)
