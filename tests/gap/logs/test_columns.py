import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.columns import known_column
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
