"""An IMU that is mounted at an angle: its trace is exercised in `signals/test_inertial.py` and
`pipeline/test_imu.py`.
"""

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects import EFFECTS, WEIGHED
from hyperleg_design.gap.signals.loading import load_subject

TURNED = WEIGHED["turned_imu"]


def test_answers_do_not_name_it_and_a_fixed_base_has_none(robot_files):
    assert "turned_imu" not in EFFECTS
    assert TURNED.locations(load_subject(robot_files["arm"])) == ()
    assert TURNED.locations(load_subject("hyperleg")) == ("imu",)


def test_it_says_the_angle_and_is_added_to_no_simulation():
    assert "turned by 0.05 rad" in TURNED.describe(np.array([0.03, -0.04, 0.0]))
    with pytest.raises(InputError, match="turn the site of the IMU"):
        TURNED.alteration("imu", np.zeros(3), load_subject("hyperleg"))
