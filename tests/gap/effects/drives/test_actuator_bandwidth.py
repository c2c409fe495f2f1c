import numpy as np
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

BANDWIDTH = effect("actuator_bandwidth")


def test_trace_is_what_a_lagging_drive_leaves(pendulum):
    for sees, residual_name in ((("motor_torque",), "drive"), ((), "motion")):
        signals = pendulum(Wrong(lag=0.012), sees=sees)
        trace = BANDWIDTH.trace(signals, "swing", np.array([[0.012]]))
        assert set(trace) == {residual_name}
        assert misfit(signals, trace, residual_name) < 0.02


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("actuator_bandwidth", [0.012])
    assert misfit(signals, BANDWIDTH.trace(signals, "swing", np.array([[0.012]])), "drive") < 0.2


def test_a_lag_is_no_delay(pendulum):
    signals = pendulum(Wrong(lag=0.02), target=fast)
    lag = BANDWIDTH.trace(signals, "swing", np.array([[0.02, 0.0]]))
    delay = effect("command_delay").trace(signals, "robot", np.array([[0.02, 0.0]]))
    assert misfit(signals, lag, "drive") < 0.1 * misfit(signals, delay, "drive")


def fast(time):
    return 0.1 * np.sin(2 * np.pi * 6 * time)
