import numpy as np
import pytest

from hyperleg_design.validation.newcomers.recorded import recorded


def test_blocks_become_columns_and_gains_are_declared():
    clock, angles = np.arange(3.0), np.arange(6.0).reshape(3, 2)
    log = recorded(
        "run",
        clock,
        [("position", ("hip", "knee"), angles)],
        ("hip", "knee"),
        (9, 8),
        (2, 1),
        a="b",
    )
    assert list(log.signals) == ["position/hip", "position/knee"]
    np.testing.assert_array_equal(log.signals["position/knee"], [1, 3, 5])
    assert log.metadata == {"gains": {"hip": [9.0, 2.0], "knee": [8.0, 1.0]}, "a": "b"}


def test_a_joint_without_gains_is_no_log():
    with pytest.raises(ValueError, match="shorter"):
        recorded("run", np.arange(3.0), [], ("hip", "knee"), (9,), (2, 1))
