from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.evaluation.measures import BEARING
from hyperleg_design.evaluation.motion.loads import load_measures

USE = SimpleNamespace(
    limit_share=np.array([0.1, 0.3]),
    continuous_use=np.array([0.8, 0.2]),
    thermal_peak=np.array([0.4, 0.5]),
)


def swing(samples, amplitude):
    """Two joints of which the first swings over its range of motion, -1 .. 1."""
    position = np.zeros((samples, 2))
    position[:, 0] = amplitude * np.sin(np.linspace(0, 4 * np.pi, samples))
    return SimpleNamespace(
        layout=SimpleNamespace(lower=np.array([-1.0, -1.0]), upper=np.array([1.0, 1.0])),
        joint_position=position,
        joint_velocity=np.gradient(position, 0.005, axis=0),
        stop_torque=None,
        time_step=0.005,
    )


def test_the_most_loaded_joint_and_motor_count():
    measures = load_measures(swing(400, 1.1), USE)
    assert ["largest_tilt", *measures] == list(BEARING)
    assert measures["stop_overshoot"] == pytest.approx(0.1, abs=1e-3)
    assert [measures[n] for n in ("limit_share", "continuous_use", "thermal_peak")] == [
        0.3,
        0.8,
        0.5,
    ]
    assert 0 < measures["stop_share"] < 1


def test_stops_that_nobody_recorded_have_no_power():
    measures = load_measures(swing(400, 0.5), USE)
    assert measures["stop_overshoot"] == 0.0
    assert np.isnan(measures["stop_absorbed_power"])
    assert np.isnan(measures["stop_returned_power"])


def test_a_stretch_is_measured_as_if_it_were_alone():
    trial, part = swing(400, 1.1), slice(100, 200)
    alone = swing(400, 1.1)
    for name in ("joint_position", "joint_velocity"):
        setattr(alone, name, getattr(alone, name)[part])
    trial.stop_torque = np.ones((400, 2))
    alone.stop_torque = np.ones((100, 2))
    assert load_measures(trial, USE, part) == load_measures(alone, USE)
