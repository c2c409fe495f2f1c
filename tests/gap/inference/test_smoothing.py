from dataclasses import replace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.endogenous import factors_of
from hyperleg_design.gap.inference.smoothing import smoothing

LAG = EFFECTS["actuator_bandwidth"]
USUAL = np.array([0.005])


@pytest.fixture(scope="module")
def steered(robot_files):
    """Samples of targets and positions alone."""
    return diagnosed.evidence(robot_files["servos"], diagnosed.stamped_badly(0)).samples


@pytest.mark.parametrize("lag", [0.004, 0.03])
def test_a_lag_costs_what_it_takes_of_each_frequency(steered, lag):
    term = smoothing(steered, LAG, "knee", USUAL, np.array([lag]))
    phi = np.array([lag / USUAL[0]])
    own = np.flatnonzero(steered.row == term.row)
    frequency = np.empty(len(own))
    (log,), ((*places,),) = steered.filtered_logs, steered.where
    place = next(i for i, at in enumerate(places) if at.start == own[0])
    start = 0
    for band in log.bands[place]:
        index = np.arange(len(band.used)) % 8
        frequency[start : start + len(index)] = (
            band.low + (band.high - band.low) * (index + 0.5) / 8
        )
        start += len(index)

    def passed(constant):
        return -0.5 * term.number @ np.log1p((2 * np.pi * frequency * constant) ** 2)

    assert term.log(phi) == pytest.approx(passed(lag))
    slope = (passed(lag + 1e-6) - passed(lag - 1e-6)) / 2e-6 * USUAL[0]
    assert term.slopes(phi)[0] == pytest.approx(slope, rel=1e-4)
    assert term.log(phi) < 0
    assert (term.number >= 0).all()
    assert (term.number <= steered.share[own]).all()


def test_a_drive_that_follows_at_once_costs_nothing(steered):
    term = smoothing(steered, LAG, "knee", USUAL, np.zeros(1))
    assert term.log(np.zeros(1)) == 0
    assert term.log(np.array([0.05])) == pytest.approx(0, abs=0.5)


def test_measured_torques_cost_nothing_and_other_effects_no_lag(robot_files, steered):
    measured = diagnosed.evidence(robot_files["coupled"], diagnosed.run("healthy", 0)).samples
    assert smoothing(measured, LAG, "m_front", USUAL, USUAL) is None
    assert factors_of(measured, "actuator_bandwidth", "m_front", USUAL, USUAL) == ()
    assert smoothing(steered, EFFECTS["torque_constant"], "knee", USUAL, USUAL) is None
    (term,) = factors_of(steered, "actuator_bandwidth", "knee", USUAL, USUAL)
    quiet = replace(steered, floor=1e6 * steered.floor)
    (noise,) = factors_of(quiet, "actuator_bandwidth", "knee", USUAL, USUAL)
    assert term.number.sum() > 1
    assert noise.number.sum() == 0
