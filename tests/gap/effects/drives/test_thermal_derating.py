import numpy as np
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
    torque, rise = warm.believed[:, 0], np.zeros(len(warm.time))
    heat = RATED_RISE * (torque / rated_torque(warm.subject, 0)) ** 2
    for tick in range(1, len(rise)):
        rise[tick] = rise[tick - 1] + (heat[tick - 1] - rise[tick - 1]) * warm.step / TIME_CONSTANT
    lost = (0.01 * rise * torque)[None, :, None]
    assert misfit(warm, {"motion": lost}) < 0.2
