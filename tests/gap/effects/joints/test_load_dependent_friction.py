import numpy as np
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

LOAD = effect("load_dependent_friction")


def test_trace_is_what_a_lossy_gear_leaves(pendulum):
    signals = pendulum(Wrong(share=0.25))
    assert misfit(signals, LOAD.trace(signals, "swing", np.array([[0.25]]))) < 0.2


def test_simulation_with_it_leaves_its_trace(simulated, leg):
    signals = simulated("load_dependent_friction", [0.2])
    assert misfit(signals, LOAD.trace(signals, "swing", np.array([[0.2]]))) < 0.35


def test_rotors_of_a_coupled_leg_do_not_load_its_gears(leg):
    signals = leg(duration=2.0)
    trace = LOAD.trace(signals, "knee", np.array([[1.0]]))["motion"][0]
    link = signals.rigid - signals.acceleration @ signals.subject.armature.T
    moving = signals.valid & (np.abs(signals.velocity[:, 1]) > 0.2)
    np.testing.assert_allclose(
        np.abs(trace[moving, 1]), np.abs(link[moving, 1]), atol=0.05 * np.abs(link).max()
    )
    assert np.all(trace[:, 0] == 0)
