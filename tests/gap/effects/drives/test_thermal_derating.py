import numpy as np
import pytest
from pendulum import Wrong, misfit, temperature

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.drives.thermal_derating import (
    RATED_RISE,
    TIME_CONSTANT,
    rated_torque,
)
from hyperleg_design.gap.inference.effect_traces import lacking

DERATING = effect("thermal_derating")
SEES = ("motor_torque", "temperature")


def test_trace_is_what_a_warm_motor_leaves(pendulum):
    signals = pendulum(Wrong(derating=0.005), sees=SEES)
    assert misfit(signals, DERATING.trace(signals, "swing", np.array([[0.005]]))) < 0.02


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("thermal_derating", [0.005], temperature=temperature)
    assert misfit(signals, DERATING.trace(signals, "swing", np.array([[0.005]]))) < 0.02


def test_a_motor_without_a_thermometer_is_not_judged(pendulum):
    signals = pendulum(Wrong(derating=0.005))
    assert DERATING.trace(signals, "swing", np.array([[0.005]])) == {}
    assert "lack the signals" in lacking(DERATING, "swing", [signals])


def test_without_a_thermometer_squared_torque_heats_the_motor_of_a_simulation(simulated):
    warm = simulated("thermal_derating", [0.01])
    torque = warm.believed[:, 0] / rated_torque(warm.subject, 0)
    heat = RATED_RISE / TIME_CONSTANT * np.cumsum(torque**2) * warm.step
    left = warm.residual["motion"][:, 0]
    use = warm.valid & np.isfinite(left)
    lost = (0.01 * heat * warm.believed[:, 0])[use]
    assert (left[use] @ lost) / (lost @ lost) == pytest.approx(1.0, abs=0.3)
