"""New causes beside standing ones: their traces together against both effects at once."""

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.interactions import after, carrying
from hyperleg_design.gap.inference.linearisation import linearise
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.signals.conditioning import condition

MOTOR = "m_back"


@pytest.fixture(scope="module")
def tests(robot_files):
    return diagnosed.evidence(robot_files["coupled"], diagnosed.run("limited", 0)).tests


def standing(tests, effect, *values):
    values = np.array(values)
    return [(linearise(tests, EFFECTS[effect], MOTOR, values), values)]


def trace(samples, effect, *values):
    one = EFFECTS[effect]
    return samples.columns(lambda s: one.trace(s, MOTOR, np.array([values])), 1)[0]


def test_scales_of_one_motor_multiply(tests):
    lacking = standing(tests, "torque_constant", 0.8, 0.0)
    added = trace(after(tests, lacking), "torque_constant", 0.75, 0.0)
    both = trace(tests, "torque_constant", 0.8, 0.0) + added
    np.testing.assert_allclose(both, trace(tests, "torque_constant", 0.6, 0.0), atol=1e-9)


def test_a_lag_after_a_lag_is_that_of_both_in_a_row(tests):
    effect = EFFECTS["actuator_bandwidth"]
    late = after(tests, standing(tests, "actuator_bandwidth", 0.03))
    signals, lagging = (one.filtered_logs[0].signals for one in (tests, late))
    motor = signals.subject.motors.index(MOTOR)
    first = effect.trace(signals, MOTOR, np.array([[0.03]]))["drive"][0, :, motor]
    np.testing.assert_allclose(lagging.command[:, motor], signals.command[:, motor] + first)
    alone = trace(tests, "actuator_bandwidth", 0.01)
    assert np.abs(trace(late, "actuator_bandwidth", 0.01)).max() < np.abs(alone).max()


def test_what_was_measured_stays(tests):
    late = after(tests, standing(tests, "actuator_bandwidth", 0.03))
    np.testing.assert_array_equal(late.value, tests.value)
    assert late.filtered_logs[0].signals.residual is tests.filtered_logs[0].signals.residual


@pytest.mark.parametrize("standing", [False, True])
def test_gears_rub_by_all_that_they_carry(robot_files, standing):
    """A load beside friction under load, against a model that carries the load already."""
    found = diagnosed.evidence(
        robot_files["coupled"],
        diagnosed.run("healthy", 0),
        references=(diagnosed.run("healthy", 1, role="reference"),),
    )
    values = np.array([0.5, 0.0, 0.0, -0.2, 0.0])
    cause = linearise(found.tests, EFFECTS["payload"], "shank", values)
    cause = found.on_all_samples(cause, standing)
    carried = carrying(found.samples, [(cause, values)], 1)
    np.testing.assert_array_equal(carried.value, found.samples.value)
    load = Metadata(payload={"shank": (0.5, 0.0, 0.0, -0.2)})
    for place, log in enumerate(carried.filtered_logs):
        signals = log.signals
        loaded = condition(signals.log.changed(metadata=load), signals.subject)
        plain = found.samples.filtered_logs[place].signals
        here = standing or place == 0
        assert not np.allclose(loaded.rigid, plain.rigid, atol=0.1)
        np.testing.assert_allclose(signals.rigid, (loaded if here else plain).rigid, atol=1e-6)
