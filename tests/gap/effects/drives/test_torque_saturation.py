import dataclasses

import numpy as np
import pytest
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.drives.torque_saturation import LEAST, NEAR, SENSED

SATURATION = effect("torque_saturation")


def test_trace_is_what_a_limited_drive_leaves_where_torque_was_measured_and_where_not(pendulum):
    for sees, residual_name in ((("motor_torque",), "drive"), ((), "motion")):
        signals = pendulum(Wrong(limit=1.0), sees=sees)
        trace = SATURATION.trace(signals, "swing", np.array([[1.0]]))
        assert set(trace) == {residual_name}
        assert misfit(signals, trace, residual_name) < 0.01


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("torque_saturation", [1.0])
    assert misfit(signals, SATURATION.trace(signals, "swing", np.array([[1.0]])), "drive") < 0.02


def test_starts_bind_ever_more_often(pendulum):
    signals = pendulum(Wrong())
    starts = 1 / SATURATION.starts(signals, "swing")[1:, 0]
    bound = [np.mean(np.abs(signals.command[:, 0]) > limit) for limit in starts]
    assert np.all(np.diff(starts) < 0)
    assert np.all(np.diff(bound) > 0)


def test_the_first_start_is_what_a_drive_gives_at_most_however_much_it_is_asked_for(pendulum):
    for limit in (0.8, 0.3):
        signals = pendulum(Wrong(limit=limit), sees=())
        assert 0.6 * limit < 1 / SATURATION.starts(signals, "swing")[0, 0] < 1.2 * limit


def test_people_read_the_limit(pendulum):
    subject = pendulum(Wrong()).subject
    assert SATURATION.derived("swing", np.array([0.5]), subject) == {"limit": (2.0, "Nm")}
    assert SATURATION.derived("swing", SATURATION.nulls, subject) == {"limit": (np.inf, "Nm")}


def test_without_commands_there_is_no_trace(pendulum):
    signals = dataclasses.replace(pendulum(Wrong()), command=None)
    assert SATURATION.trace(signals, "swing", np.array([[1.0]])) == {}


def test_a_drive_that_gives_next_to_nothing_is_no_limited_one(pendulum):
    signals = pendulum(Wrong())
    low, high = SATURATION.bounds("swing", signals.subject)[:, 0]
    strength = 1 / (0.6 * SATURATION.usual("swing", signals.subject)[0])
    assert low == 0
    assert 1 / high == pytest.approx(LEAST * strength)
    assert np.all(SATURATION.starts(signals, "swing") <= high)


def test_no_limit_is_below_a_torque_that_was_measured(pendulum):
    signals = pendulum(Wrong())
    low, high = SATURATION.bounds("swing", signals.subject)

    def bounds(held):
        torque = np.zeros_like(signals.command)
        torque[100 : 100 + held, 0] = -1.5
        changed = dataclasses.replace(signals, measured=torque)
        return SATURATION.shown_bounds([changed], "swing")

    np.testing.assert_allclose(bounds(3), [low, [SENSED / 1.5]])
    np.testing.assert_array_equal(bounds(2), [low, high])
    unknown = dataclasses.replace(signals, measured=None)
    np.testing.assert_array_equal(SATURATION.shown_bounds([unknown], "swing"), [low, high])


def test_a_limit_near_the_models_is_an_error_of_the_torque_constant(pendulum):
    signals = pendulum(Wrong())
    low, _ = SATURATION.bounds("swing", signals.subject)
    near = dataclasses.replace(signals.subject, torque_limit=np.array([5.0]))
    changed = dataclasses.replace(signals, subject=near, measured=None)
    assert SATURATION.shown_bounds([changed], "swing")[0] == pytest.approx(1 / (NEAR * 5.0))
    unknown = dataclasses.replace(signals.subject, torque_limit=np.array([np.inf]))
    changed = dataclasses.replace(signals, subject=unknown, measured=None)
    assert SATURATION.shown_bounds([changed], "swing")[0] == low
