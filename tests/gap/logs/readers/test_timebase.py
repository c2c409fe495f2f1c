import numpy as np

from hyperleg_design.gap.logs.readers.timebase import onto, sorted_stream


def test_interpolates_lines_exactly_and_leaves_gaps():
    own = np.concatenate([np.arange(0, 1, 0.01), np.arange(2, 3, 0.01)])
    time = np.linspace(-0.5, 3.5, 4001) + 0.0003
    found = onto(time, own, {"gyro/x": 3 * own + 1}, hold=False)["gyro/x"]
    inside = ((time >= 0) & (time < 0.99)) | ((time >= 2) & (time < 2.99))
    np.testing.assert_allclose(found[inside], 3 * time[inside] + 1)
    assert np.isnan(found[~inside]).all()


def test_targets_hold_until_the_next():
    found = onto(
        np.array([-1, 0, 0.5, 1, 1.9, 2.5]),
        np.array([0.0, 1, 2]),
        {"a": np.array([10.0, 11, 12])},
        hold=True,
    )["a"]
    np.testing.assert_array_equal(found, [np.nan, 10, 10, 11, 11, 12])


def test_sorting():
    time, signals, disorder = sorted_stream(
        np.array([0.0, 2, 1, 1]), {"a": np.array([0.0, 2, 1, 5])}
    )
    np.testing.assert_array_equal(time, [0, 1, 2])
    np.testing.assert_array_equal(signals["a"], [0, 1, 2])
    assert disorder == 1
