from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.gap.effects.strength import joint_strength
from hyperleg_design.gap.effects.usual import lateness, least_friction
from hyperleg_design.gap.signals.loading import load_subject


def test_slow_logs_are_later_by_a_part_of_a_tick_and_fast_ones_by_the_drives_alone():
    assert 0 < lateness(0.0) < 0.005
    assert lateness(0.005) - lateness(0.0) == pytest.approx(5 * (lateness(0.001) - lateness(0.0)))
    assert lateness(0.01) - lateness(0.0) < 0.01


def test_usual_friction_is_a_small_share_of_what_joints_are_made_for(robot_files):
    subject = load_subject(robot_files["servos"])
    found = least_friction(subject)
    assert found.shape == (2,)
    assert (found > 0).all()
    assert (found < 0.01 * joint_strength(subject)).all()
    # servos of 80 and 60 Nm
    assert found[0] / found[1] == pytest.approx(80 / 60)
    friction = replace(subject, coulomb=10 * subject.coulomb)
    np.testing.assert_array_equal(least_friction(friction), found)
