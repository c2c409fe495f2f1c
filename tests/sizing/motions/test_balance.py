import numpy as np
import pytest

from hyperleg_design.errors import InfeasibleError
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing.motions.balance import Series, highest_pelvis
from hyperleg_design.sizing.motions.squat import standing_feet

TIME = np.arange(101) * 2.0 / 101
PERIODIC = Series(2.0 / 101, mirrored=False)


def test_derivatives_of_harmonics_are_exact():
    wave = np.sin(3 * np.pi * TIME) + 0.5 * np.cos(np.pi * TIME)
    value, rate, turn = PERIODIC.derivatives(wave)
    np.testing.assert_allclose(value, wave, atol=1e-12)
    np.testing.assert_allclose(
        rate, 3 * np.pi * np.cos(3 * np.pi * TIME) - 0.5 * np.pi * np.sin(np.pi * TIME), atol=1e-10
    )
    np.testing.assert_allclose(
        turn,
        -9 * np.pi**2 * np.sin(3 * np.pi * TIME) - 0.5 * np.pi**2 * np.cos(np.pi * TIME),
        atol=1e-9,
    )


def test_filter_solves_its_equation():
    wanted = np.sign(np.sin(np.pi * TIME + 0.1))
    found = PERIODIC.filtered(wanted, 0.3)
    np.testing.assert_allclose(found - 0.3**2 * PERIODIC.derivatives(found)[2], wanted, atol=1e-9)


def test_integral_undoes_derivative():
    wave = np.sin(5 * np.pi * TIME)
    np.testing.assert_allclose(
        PERIODIC.integrated_twice(PERIODIC.derivatives(wave)[2] + 7.0), wave, atol=1e-10
    )


def test_mirrored_motion_rests_at_its_ends():
    time = np.linspace(0, 1, 101)
    value, rate, _ = Series(0.01, mirrored=True).derivatives(
        np.stack([time**2 * (3 - 2 * time), 1 - time], -1)
    )
    np.testing.assert_allclose(rate[[0, -1]], 0.0, atol=1e-9)
    assert value.shape == (101, 2)


def test_highest_pelvis_stands_on_the_chosen_knee():
    design = load_design()
    feet = standing_feet(design, 3)
    place = np.zeros((3, 2))
    assert highest_pelvis(design, place, feet, np.zeros(3), 0.0) == pytest.approx(0.786)
    assert highest_pelvis(design, place, feet, np.array([0, 0.1, 0]), 0.0) == pytest.approx(0.686)
    assert highest_pelvis(design, place, feet, np.zeros(3), 0.5) < 0.786
    with pytest.raises(InfeasibleError, match="a foot would have to be"):
        highest_pelvis(design, place + 2.0, feet, np.zeros(3), 0.0)
