import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.columns import known_column, misspelt
from hyperleg_design.gap.logs.log import Log


def example(ticks: int = 50, **signals: np.ndarray) -> Log:
    time = np.arange(ticks) * 0.005
    return Log(
        "run", time, {"position/knee": np.sin(time), "motor_current/m": np.cos(time), **signals}
    )


@pytest.mark.parametrize(
    "column",
    [
        "position",
        "gyro/q",
        "battery_voltage/x",
        "contact_force/foot",
        "speed/knee",
        "t",
        "position/",
    ],
)
def test_unknown_columns(column):
    assert not known_column(column)
    with pytest.raises(InputError, match="no column of the log format"):
        example(**{column: np.ones(50)})


def test_a_nearly_right_signal_is_misspelt_unless_the_right_one_is_there():
    assert misspelt(["t", "motor_torqe/a", "gyro/x"]) == ("motor_torqe/a", "motor_torque/a")
    assert misspelt(["batery_voltage"]) == ("batery_voltage", "battery_voltage")
    assert misspelt(["positions/knee", "position/knee", "temperature/knee", "mood", "t"]) is None
