import numpy as np
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

CONSTANT = effect("torque_constant")


def test_trace_is_what_a_weak_motor_leaves(pendulum):
    for sees in (("motor_torque",), ()):
        signals = pendulum(Wrong(constant=0.85), sees=sees)
        trace = CONSTANT.trace(signals, "swing", np.array([[0.85]]))
        assert set(trace) == {"motion"}
        assert misfit(signals, trace) < 0.02


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("torque_constant", [0.85])
    assert misfit(signals, CONSTANT.trace(signals, "swing", np.array([[0.85]]))) < 0.02
