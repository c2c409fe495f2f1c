from dataclasses import replace

import numpy as np
import pytest
from pendulum import Wrong

from hyperleg_design.gap.effects.unlisted.inputs import INPUTS, SHAPES, functions, relative_load


@pytest.mark.parametrize("name", INPUTS)
def test_functions_are_of_the_order_of_one_and_few(leg, name):
    signals = leg(duration=1.5)
    found = functions(signals, 1, name)
    assert 0 < len(found) <= SHAPES
    assert found.shape[1] == len(signals.time)
    assert np.isfinite(found).all()
    size = np.sqrt(np.mean(found**2, 1))
    assert (size < 30).all()
    assert size.max() > 0.01


def test_a_joint_alone_has_no_others(pendulum):
    signals = pendulum(Wrong())
    assert functions(signals, 0, "others").shape == (0, len(signals.time))


def test_no_function_of_speed_is_friction(pendulum):
    signals = pendulum(Wrong())
    speed = signals.velocity[:, 0]
    listed = np.stack([np.ones_like(speed), speed, np.sign(speed)], -1)
    for one in functions(signals, 0, "speed"):
        left = one - listed @ np.linalg.lstsq(listed, one, rcond=None)[0]
        assert np.std(left) > 0.05 * np.std(one)


def test_a_joint_without_a_drive_has_no_load(leg):
    signals = leg(duration=1.5)
    subject = replace(signals.subject, passive=np.arange(len(signals.subject.joints)) == 1)
    passive = replace(signals, subject=subject)
    assert not relative_load(passive, 1).any()
    assert relative_load(passive, 0).any()
    assert not functions(passive, 1, "strength").any()
