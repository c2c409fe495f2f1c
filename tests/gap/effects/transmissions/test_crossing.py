import dataclasses

import numpy as np
import pytest
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.transmissions.crossing import crossed

SEES = ("motor_torque", "motor_velocity")
SOFT = (15.0, 0.5)


def test_a_rotor_is_followed_from_end_to_end_of_its_play(pendulum):
    """One with friction, which rests at the ends."""
    signals = pendulum(Wrong(play=0.02, rotor_viscous=2.0), gains=SOFT, sees=SEES)
    place = crossed(signals, 0)
    assert place is not None
    assert np.ptp(place) == pytest.approx(1)
    stretched = np.cumsum(signals.residual["transmission"][:, 0]) * signals.step
    stretched -= stretched.mean() - 0.02 * place.mean()
    assert np.std(stretched - 0.02 * place) < 0.35 * np.std(stretched)
    trace = effect("backlash").trace(signals, "swing", np.array([[0.02, 0.0, 1.0, 0.0]]))
    assert misfit(signals, trace, "transmission") < 0.4


@pytest.mark.parametrize(
    "wrong", [Wrong(), Wrong(compliance=0.005), Wrong(coulomb=0.5), Wrong(ratio=1.1)]
)
def test_nothing_crosses_where_there_is_no_play(pendulum, wrong):
    assert crossed(pendulum(wrong, gains=SOFT, sees=SEES), 0) is None


def test_speeds_that_are_off_by_a_ratio_are_no_play(pendulum):
    signals = pendulum(Wrong(), gains=SOFT, sees=SEES)
    slip = signals.residual["transmission"] + 0.02 * signals.velocity
    off = dataclasses.replace(signals, residual=signals.residual | {"transmission": slip})
    assert crossed(off, 0) is None


def test_without_speeds_of_rotors_nothing_is_seen(pendulum):
    assert crossed(pendulum(Wrong(play=0.02), gains=SOFT), 0) is None


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_slips_one_way_is_no_play(pendulum, sign):
    signals = pendulum(Wrong(), gains=SOFT, sees=SEES)
    slip = signals.residual["transmission"].copy()
    slip[300:310] += sign
    slip[900:910] += sign
    off = dataclasses.replace(signals, residual=signals.residual | {"transmission": slip})
    assert crossed(off, 0) is None
