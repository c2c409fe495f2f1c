import diagnosed
import numpy as np
import pytest
import robots

from hyperleg_design.gap.inference import preparation
from hyperleg_design.gap.inference.base import Prior
from hyperleg_design.gap.inference.fit import Design
from hyperleg_design.gap.inference.nuisance import TURNOVER, NuisanceParameter
from hyperleg_design.gap.inference.preparation import MOST_SESSIONS, sessions_of
from hyperleg_design.gap.inference.thresholds import load_thresholds


def test_logs_without_a_session_are_sessions_of_their_own(robot_files):
    logs = [
        diagnosed.run("healthy", 0, session="a"),
        diagnosed.run("healthy", 1),
        diagnosed.run("healthy", 2, session="a"),
    ]
    signals = diagnosed.conditioned(robot_files["coupled"], *logs)
    assert sessions_of(signals).tolist() == [0, 1, 0]
    assert (
        sessions_of(diagnosed.conditioned(robot_files["coupled"], *[logs[1]] * 6)).max()
        == MOST_SESSIONS - 1
    )


def test_what_reference_logs_know_is_not_found_again(robot_files):
    healthy = [diagnosed.run("viscous", s, session="before", role="reference") for s in (2, 3)]
    test = diagnosed.run("viscous", 0, session="today")
    known = diagnosed.prepared(robot_files["coupled"], test, references=healthy)
    assert known.calibrated
    place = next(
        i
        for i, e in enumerate(known.errors)
        if (e.effect, e.location) == ("viscous_friction", "knee")
    )
    assert known.base.prior.mean[place] * known.errors[place].spread > 0.2
    fit = Design(known.base).fit()
    assert np.sqrt(np.mean(fit.rss / np.maximum(known.base.number.sum(0), 1e-9))) < 2
    alone = diagnosed.prepared(robot_files["coupled"], test)
    assert not alone.calibrated
    assert np.sum(Design(alone.base).fit().rss) > 10 * np.sum(fit.rss)


def test_what_the_accelerometer_feels_too_much_is_known_along_the_vertical_alone(monkeypatch):
    spread = 0.05
    errors = [
        NuisanceParameter("link_mass", "pelvis", 0, 0.4),
        *(NuisanceParameter("imu_bias", "imu", i, spread) for i in (3, 4, 5)),
    ]
    rng = np.random.default_rng(3)
    root = rng.normal(size=(4, 6))
    prior = Prior(rng.normal(size=4), root @ root.T)
    up, error, deviation = np.array([0.1, -0.2, np.sqrt(0.95)]), 0.08, 0.012
    monkeypatch.setattr(preparation, "felt_upright", lambda signals: (up, error, deviation))
    known = preparation._felt(prior, errors, [])
    row = np.r_[0, spread * up]
    precision = prior.precision + np.outer(row, row) / deviation**2  # Bayes' rule, by information
    np.testing.assert_allclose(known.precision, precision, rtol=1e-6)
    np.testing.assert_allclose(
        precision @ known.mean, prior.precision @ prior.mean + row * error / deviation**2, rtol=1e-6
    )
    assert row @ known.mean == pytest.approx(error, abs=3 * deviation)
    assert preparation._felt(prior, errors[:1] * 4, []) is prior
    monkeypatch.setattr(preparation, "felt_upright", lambda signals: None)
    assert preparation._felt(prior, errors, []) is prior


def test_friction_that_the_model_lacks_is_calibrated_and_turns_over_as_that_of_the_model(tmp_path):
    """Of a drive that loses a tenth of its torque, described by nobody."""
    robot, friction, damping = tmp_path / "servo.xml", 0.3, 0.15
    plain = robots.PENDULUM.replace(
        '<motor name="servo" joint="swing" ctrlrange="-3 3"/>',
        '<position name="servo" joint="swing" kp="8" kv="0.1" forcerange="-3 3"/>',
    )
    robot.write_text(plain)
    real = plain.replace('damping="0.02"', f'damping="{damping}" frictionloss="{friction}"')
    days = (("before", "reference"), ("before", "reference"), ("today", "test"))
    logs = [
        robots.servo_run(real, robots.swift(seed), 12.0, session=day, role=role)
        for seed, (day, role) in enumerate(days)
    ]
    signals = diagnosed.conditioned(robot, *logs)
    known = preparation.prepare(signals[2:], signals[:2], load_thresholds(None))
    place = {
        (e.effect, e.parameter): i for i, e in enumerate(known.errors) if e.location == "swing"
    }
    mean = known.base.prior.mean * np.array([e.spread for e in known.errors])
    assert mean[place["coulomb_friction", 0]] == pytest.approx(friction, rel=0.15)
    assert mean[place["viscous_friction", 0]] == pytest.approx(damping - 0.02, rel=0.2)
    coulomb = place["coulomb_friction", 0]
    ways = [i for (effect, _), i in place.items() if effect == TURNOVER]
    assert ways
    assert np.all(
        np.sqrt(np.diag(known.base.prior.covariance)[ways]) >= known.base.prior.mean[coulomb]
    )
    assert known.errors[coulomb].spread < 0.01 * friction
