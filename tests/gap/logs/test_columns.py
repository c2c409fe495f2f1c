import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.columns import force_names, known_column, misspelt
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


def test_forces_have_the_names_of_columns():
    names = force_names(("left", "right_toe"))
    assert names == ("left_x", "left_y", "left_z", "right_toe_x", "right_toe_y", "right_toe_z")
    known = [known_column(f"contact_force/{name}") for name in names]
    assert len(known) == len(names)
