import numpy as np
import pytest
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

LOAD = effect("load_dependent_friction")


def test_trace_is_what_a_lossy_gear_leaves(pendulum):
    """To first order: where a quarter of the drive's torque is lost, that is a third of the load's
    as it drives, and a fifth as it brakes.
    """
    signals = pendulum(Wrong(share=0.25))
    assert misfit(signals, LOAD.trace(signals, "swing", np.array([[0.25]]))) < 0.35


def test_friction_of_another_kind_is_no_share_of_the_load(pendulum):
    """Where a drive's torque is mostly Coulomb friction, this is a share of it, but not of what
    the motion needs.
    """
    rubbing, smooth = pendulum(Wrong(coulomb=0.5)), pendulum(Wrong())
    traces = [LOAD.trace(one, "swing", np.array([[1.0]]))["motion"] for one in (rubbing, smooth)]
    sizes = [np.sqrt(np.mean(trace**2)) for trace in traces]
    assert sizes[0] == pytest.approx(sizes[1], rel=0.1)


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
