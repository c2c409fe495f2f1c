import numpy as np
from pendulum import Wrong, misfit, temperature

from hyperleg_design.gap.effects import effect

DERATING = effect("thermal_derating")
SEES = ("motor_torque", "temperature")


def test_trace_is_what_a_warm_motor_leaves(pendulum):
    signals = pendulum(Wrong(derating=0.005), sees=SEES)
    assert misfit(signals, DERATING.trace(signals, "swing", np.array([[0.005]]))) < 0.02


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("thermal_derating", [0.005], temperature=temperature)
    assert misfit(signals, DERATING.trace(signals, "swing", np.array([[0.005]]))) < 0.02


def test_without_a_thermometer_squared_torque_heats_the_motor(pendulum, simulated):
    from hyperleg_design.gap.effects.drives.thermal_derating import (
        RATED_RISE,
        TIME_CONSTANT,
        rated_torque,
        rise,
    )

    signals = pendulum(Wrong())
    found = rise(signals, 0)
    assert found[0] == 0
    assert np.all(found >= 0)
    heat = (
        RATED_RISE
        / TIME_CONSTANT
        * np.sum((signals.believed[:, 0] / rated_torque(signals.subject, 0)) ** 2)
        * signals.step
    )
    assert abs(found[-1] / heat - 1) < 0.15
    signals = simulated("thermal_derating", [0.01])
    assert misfit(signals, DERATING.trace(signals, "swing", np.array([[0.01]]))) < 0.2
