"""From logs to channels."""

from dataclasses import replace

import diagnosed
import numpy as np
import pytest
from causes import unbounded

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.inference.endogenous import Factor, joined
from hyperleg_design.gap.inference.hypotheses.hypothesis_fit import HypothesisFit
from hyperleg_design.gap.inference.linearisation import linearise
from hyperleg_design.gap.inference.rules import InferenceRules


@pytest.fixture(scope="module")
def loud(robot_files):
    """Evidence of a log whose front motor's torque is lost in noise."""
    log = diagnosed.run("limited", 0)
    noise = np.random.default_rng(3).normal(0, 30.0, len(log.time))
    torque = {"motor_torque/m_front": log.column("motor_torque/m_front") + noise}
    return diagnosed.evidence(robot_files["coupled"], log.changed(signals=log.signals | torque))


def test_a_channel_that_is_mostly_noise_is_fitted_too(loud):
    (drive,) = (c for c in loud.channels if (c.residual, c.name) == ("drive", "m_front"))
    assert drive.columns == 1
    (scales, *_) = HypothesisFit(loud, InferenceRules(), {}, {}).null.scales
    assert np.isfinite(scales.noise).all()


@pytest.mark.parametrize(
    ("signal", "noise", "low", "high"),
    [("motor_torque", 5.0, 0.95, 1.0), ("position", 3e-3, 0, 0.6)],
)
def test_scaled_torques_pay_for_their_own_noise_and_not_for_that_of_accelerations(
    robot_files, signal, noise, low, high
):
    log, rng = diagnosed.run("healthy", 0), np.random.default_rng(3)
    noisy = {
        name: values + rng.normal(0, noise, len(log.time))
        for name, values in log.signals.items()
        if name.startswith(f"{signal}/")
    }
    evidence = diagnosed.evidence(robot_files["coupled"], log.changed(signals=log.signals | noisy))
    assert all(low <= share <= high for share in evidence.moved)


def test_only_errors_of_how_a_robot_is_built_and_set_are_the_same_in_all_sessions(robot_files):
    log = diagnosed.run("limited", 0)
    before = log.changed(metadata=replace(log.metadata, session="before", role="reference"))
    alone = diagnosed.evidence(robot_files["coupled"], log)
    both = diagnosed.evidence(robot_files["coupled"], log, references=[before])
    assert {channel.steady for channel in alone.channels} == {0}
    steady = {channel.residual: channel.steady for channel in both.channels}
    assert steady["motion"] > 0
    assert steady["drive"] == 1  # its current loop
    assert all(channel.steady < channel.columns for channel in both.channels)


def test_usual_errors_are_known_of_places_that_have_no_nuisance_parameter(robot_files):
    evidence = diagnosed.evidence(robot_files["coupled"], diagnosed.run("healthy", 0))
    of_all = evidence.usual["command_delay", "robot", 0]
    assert evidence.usual["command_delay", "m_front", 0] == of_all > 0
    loads = {
        place: size
        for (effect, place, i), size in evidence.usual.items()
        if (effect, i) == ("payload", 0)
    }
    assert loads
    assert all(evidence.usual["link_mass", link, 0] == size for link, size in loads.items() if size)


def test_a_cause_may_scale_torques_of_a_row_that_references_alone_have(robot_files):
    evidence = diagnosed.evidence(robot_files["coupled"], diagnosed.run("healthy", 0))
    rows = evidence.samples.rows
    lacking = replace(evidence, tests=replace(evidence.tests, rows=rows[:-1]))
    factor = Factor(0, np.ones((1, 1)), 1.0, row=len(rows) - 1)
    columns = np.ones((1, len(evidence.samples.value)))
    cause = replace(unbounded("torque_constant", "m_front", columns), factors=(factor,))
    assert lacking.scaled(cause).factors[0].number == evidence.scaled(cause).factors[0].number > 0


def test_a_reading_that_is_off_pays_in_the_residual_of_its_drive_whatever_else_scales_the_torque(
    robot_files,
):
    evidence = diagnosed.evidence(robot_files["coupled"], diagnosed.run("limited", 0))
    subject, samples = evidence.signals[0].subject, evidence.tests
    causes = {}
    for effect, values in (("torque_constant", [1.0, 1.0]), ("transmission_ratio", [1.02, 0.0])):
        found = linearise(samples, WEIGHED[effect], "m_front", np.array(values))
        causes[effect] = evidence.on_all_samples(found, False)
    rows = [samples.rows[cause.factors[0].row] for cause in causes.values()]
    assert [row.residual_name for row in rows] == ["drive", "motion"]
    assert subject.motors[rows[0].column] == "m_front"
    assert len(joined([(i, one.factors[0]) for i, one in enumerate(causes.values())])) == 2
    # a ratio scales the torque at the joint, a reading also what is compared with commands
    reading, ratio = (one.factors[0].number for one in causes.values())
    assert reading > 1.5 * ratio > 0


def test_a_larger_reading_gains_nothing_in_the_residual_of_its_drive(robot_files):
    evidence = diagnosed.evidence(robot_files["coupled"], diagnosed.run("limited", 0))
    effect = WEIGHED["torque_constant"]
    (reading, motor) = (
        evidence.on_all_samples(
            linearise(evidence.tests, effect, "m_front", np.array([1.0, choice])), False
        ).factors[0]
        for choice in (1.0, 0.0)
    )
    more = np.array([1.0])
    assert reading.log(-more) < motor.log(-more) < 0
    np.testing.assert_allclose(reading.log(more), motor.log(more), rtol=1e-9)
