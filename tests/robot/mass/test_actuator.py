"""Mass of a motor with its gear, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.robot.mass.actuator import actuator_mass


def test_a_gear_weighs_by_its_peak_output_torque():
    """RI80: 411 g and 4.1 Nm at most; 10 g a newton metre at a gear of 7."""
    assert actuator_mass("RI80", 7.0, 0.01) == pytest.approx(0.411 + 0.01 * 7 * 4.1)
    assert actuator_mass("RI80", 7.0, 0.0) == pytest.approx(0.411)


def test_motors_and_gears_of_a_batch():
    names, gears = np.array(["RI80", "GL80"]), np.array([7.0, 6.0])
    masses = actuator_mass(names, gears, 0.01)
    expected = [actuator_mass(str(n), g, 0.01) for n, g in zip(names, gears, strict=True)]
    np.testing.assert_allclose(masses, expected)
