import numpy as np
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

VISCOUS = effect("viscous_friction")


def test_trace_is_what_a_damped_pendulum_leaves(pendulum):
    signals = pendulum(Wrong(viscous=0.3))
    assert misfit(signals, VISCOUS.trace(signals, "swing", np.array([[0.3]]))) < 0.01


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("viscous_friction", [0.2])
    assert misfit(signals, VISCOUS.trace(signals, "swing", np.array([[0.2]]))) < 0.02
