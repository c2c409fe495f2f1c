from types import SimpleNamespace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.signals.channels import applied, of_motors, resampled, resampled_or_none


def test_what_is_unknown_stays_unknown_only_where_it_is_needed():
    matrix = np.array([[1.0, 2.0, 0.0], [0.0, 0.0, 3.0]])
    values = np.array([[1.0, 1.0, 1.0], [1.0, np.nan, 1.0], [np.nan, np.nan, np.nan]])
    assert np.array_equal(
        applied(matrix, values), [[3.0, 3.0], [np.nan, 3.0], [np.nan, np.nan]], equal_nan=True
    )


@given(st.integers(0, 1000))
def test_known_values_go_through_a_matrix_as_ever(seed):
    rng = np.random.default_rng(seed)
    matrix, values = rng.normal(size=(3, 2)), rng.normal(size=(5, 2))
    assert np.allclose(applied(matrix, values), values @ matrix.T)


def test_a_slow_channel_is_interpolated_and_a_gap_is_not():
    time = np.r_[0.0, 0.1, 0.2, 1.0, 1.1]
    found = resampled(time, (2 * time)[:, None], np.array([0.05, 0.15, 0.6, 1.05]))[:, 0]
    assert np.allclose(found[[0, 1, 3]], [0.1, 0.3, 2.1])
    assert np.isnan(found[2])
    assert np.isnan(resampled(time, np.full((5, 1), np.nan), time)).all()
    assert resampled_or_none(time, np.full((5, 1), np.nan), time) is None


def test_signals_of_motors_are_found_under_either_name_and_brought_to_the_robots_side_of_gears():
    subject = SimpleNamespace(
        motors=("hip", "knee"),
        motor_aliases=("a", "knee"),
        motor_scale={"motor_torque": np.array([10.0, -2.0])},
    )
    log = Log(
        "run",
        np.arange(3.0),
        {
            "position/hip": np.zeros(3),
            "motor_torque/a": np.ones(3),
            "motor_torque/knee": np.ones(3),
        },
    )
    assert np.array_equal(of_motors(log, "motor_torque", subject), np.tile([10.0, -2.0], (3, 1)))
    assert np.isnan(of_motors(log, "motor_current", subject)).all()
