import math

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.readers.units import factor, split_header


@pytest.mark.parametrize(
    ("header", "found"),
    [
        ("position/knee [deg]", ("position/knee", "deg")),
        ("t (ms)", ("t", "ms")),
        (" velocity/knee ", ("velocity/knee", "")),
        ("a[0] [A]", ("a[0]", "A")),
    ],
)
def test_headers(header, found):
    assert split_header(header) == found


@pytest.mark.parametrize(
    ("column", "unit", "value"),
    [
        ("position/knee", "deg", math.pi / 180),
        ("motor_velocity/m", "rpm", math.pi / 30),
        ("motor_current/m", "mA", 1e-3),
        ("t", "us", 1e-6),
        ("accelerometer/x", "g", 9.80665),
        ("battery_voltage", "", 1.0),
        ("joint_torque/knee", "Nm", 1.0),
        ("position/slide", "mm", 1e-3),
        ("position_target/slide", "m", 1.0),
        ("velocity/slide", "m/s", 1.0),
        ("motor_torque/slide", "kN", 1e3),
    ],
)
def test_factors(column, unit, value):
    assert factor(column, unit, "run.csv") == pytest.approx(value)


def test_a_unit_of_another_signal():
    with pytest.raises(InputError, match=r"run.csv: position/knee = 'Nm'.*there are rad, deg"):
        factor("position/knee", "Nm", "run.csv")
