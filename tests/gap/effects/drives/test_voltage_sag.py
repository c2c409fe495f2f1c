from dataclasses import replace

import numpy as np
import pytest
from pendulum import Wrong, misfit, voltage

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.inference.effect_traces import lacking

SAG = effect("voltage_sag")


def test_trace_is_what_a_falling_voltage_leaves(pendulum):
    for sees, residual_name in ((("motor_torque", "voltage"), "drive"), (("voltage",), "motion")):
        signals = pendulum(Wrong(follow=1.0), sees=sees)
        trace = SAG.trace(signals, "battery", np.array([[0.0, 1.0, 10.0]]))
        assert set(trace) == {residual_name}
        # what the battery lost before the recording nobody can tell
        assert misfit(signals, trace, residual_name) < 0.1


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("voltage_sag", [0.0, 1.0, 10.0], battery=voltage)
    assert (
        misfit(signals, SAG.trace(signals, "battery", np.array([[0.0, 1.0, 10.0]])), "drive") < 0.25
    )


def test_an_unknown_line_falls_with_voltage_and_speed(pendulum, simulated):
    signals = simulated("voltage_sag", [4.0, 0.0, 4.0], battery=voltage)
    found = SAG.trace(signals, "battery", np.array([[4.0, 0.0, 4.0]]))
    assert misfit(signals, found, "drive") < 0.1
    still = SAG.trace(signals, "battery", np.array([[4.0, 0.0, 60.0]]))
    assert misfit(signals, still, "drive") > 2 * misfit(signals, found, "drive")


def test_an_unknown_line_follows_the_speed_that_known_ones_do(simulated):
    signals = simulated("voltage_sag", [4.0, 0.0, 4.0], battery=voltage)
    faster = replace(signals, motor_speed=2 * signals.motor_speed)
    of_line, of_speed = (
        SAG.trace(log, "battery", np.array([[4.0, 0.0, speed]]))
        for log, speed in ((signals, 4.0), (faster, 8.0))
    )
    assert np.any(of_line["drive"])
    np.testing.assert_allclose(of_speed["drive"], of_line["drive"], atol=1e-12)


def test_the_battery_is_also_the_robot(pendulum):
    assert SAG.place("robot", pendulum(Wrong()).subject) == "battery"


def test_a_line_that_a_motor_falls_short_of_is_read_off_its_torque(pendulum, simulated):
    weak = simulated("voltage_sag", [4.0, 0.0, 4.0], battery=voltage)
    line, *usual = SAG.starts(weak, "battery")
    assert line[0] == pytest.approx(4.0, rel=0.25)
    assert line[2] == pytest.approx(4.0, rel=0.25)
    assert np.array_equal(
        usual, SAG.starts(pendulum(Wrong(), sees=("motor_torque", "voltage")), "battery")
    ), "a healthy motor gives what it is told"


def test_a_battery_whose_voltage_nobody_logged_is_not_judged(pendulum):
    signals = pendulum(Wrong(follow=1.0))
    assert SAG.trace(signals, "battery", np.array([[0.0, 1.0, 10.0]])) == {}
    assert "lack the signals" in lacking(SAG, "battery", [signals])
