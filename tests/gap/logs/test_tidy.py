import numpy as np

from hyperleg_design.gap.logs.tidy import tidied


def test_tidied_leaves_out_rows_without_time_and_infinities():
    time, signals, remarks = tidied(
        np.array([0, 1, np.nan, 2]), {"position/knee": np.array([1, np.inf, 3, 4])}, "run"
    )
    np.testing.assert_array_equal(time, [0, 1, 2])
    np.testing.assert_array_equal(signals["position/knee"], [1, np.nan, 4])
    assert len(remarks) == 2
