from dataclasses import replace

import diagnosed
import numpy as np
import pytest
import robots

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.placing import joint_strength
from hyperleg_design.gap.inference.nuisance import (
    FILTERED,
    FORCES_SCALED,
    OF_WAY,
    TURNOVER,
    UNLISTED,
    WAYS,
    nuisance_parameters,
)
from hyperleg_design.gap.inference.nuisance_traces import columns, traces
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.filtering import filtered_log
from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture(scope="module")
def signals(robot_files):
    return diagnosed.conditioned(robot_files["coupled"], diagnosed.run("healthy", 0))[0]


@pytest.fixture(scope="module")
def errors(signals):
    return nuisance_parameters(signals.subject, signals.step)


def test_every_error_belongs_to_the_catalogue_and_to_a_place_of_the_robot(signals, errors):
    for one in errors:
        assert one.spread > 0
        assert one.effect in (TURNOVER, *UNLISTED) or one.location in EFFECTS[one.effect].locations(
            signals.subject
        )


def test_friction_of_which_the_model_tells_nothing_turns_over_once_it_is_calibrated(
    signals,
):
    subject = signals.subject
    bare = replace(
        subject,
        coulomb=np.where(np.arange(len(subject.joints)) == subject.joints.index("knee"), 0.3, 0.0),
    )
    alone, calibrated = (
        nuisance_parameters(bare, signals.step),
        nuisance_parameters(bare, signals.step, calibrated=True),
    )
    more = [e for e in calibrated if e not in alone]
    expected = {
        (TURNOVER, joint, 1 + i)
        for joint in subject.joints
        if joint != "knee"
        for i in range(len(WAYS))
    }
    assert {(e.effect, e.location, e.parameter) for e in more} == expected
    strength = dict(zip(subject.joints, joint_strength(bare), strict=True))
    trace = next(
        t
        for e, t in zip(calibrated, traces(replace(signals, subject=bare), calibrated), strict=True)
        if e in more
    )
    assert 0 < np.abs(trace["motion"]).max() < OF_WAY * 0.001 * strength["hip"] * 2


def test_friction_under_load_is_no_share_of_the_measured_torque_where_the_model_has_no_friction(
    signals, errors
):
    bare = replace(
        signals, subject=replace(signals.subject, coulomb=np.zeros_like(signals.subject.coulomb))
    )
    errors = [one for one in errors if one.effect != TURNOVER]
    rubbing = replace(bare, believed=3 * signals.believed)
    for one, now, then in zip(
        errors, traces(rubbing, errors, True), traces(bare, errors, True), strict=True
    ):
        if one.effect == "load_dependent_friction":
            np.testing.assert_array_equal(now["motion"], then["motion"])


def test_usual_errors_are_smaller_than_usual_causes(signals, errors):
    for one in errors:
        if one.effect not in (TURNOVER, *UNLISTED, "controller_gain"):
            usual = EFFECTS[one.effect].usual(one.location, signals.subject)[one.parameter]
            assert one.spread < 0.7 * abs(usual), one.name


def test_traces_are_those_of_the_effects(signals, errors):
    place = next(
        i for i, e in enumerate(errors) if e.effect == "viscous_friction" and e.location == "knee"
    )
    found = traces(signals, errors)[place]["motion"]
    assert np.allclose(found[:, 1], errors[place].spread * signals.velocity[:, 1])
    assert not found[:, 0].any()
    sampled = columns(filtered_log(signals), errors)
    assert sampled[1][place].any()
    assert not sampled[0][place].any()


def targets_alone(seed, **given):
    log = robots.geared_run("joint", ("hip", "knee"), seed=seed, **given)
    kept = {c: v for c, v in log.signals.items() if not c.startswith("motor")}
    return log.changed(signals=kept)


@pytest.fixture
def geared(robot_files):
    return robot_files["geared"]


def test_gains_take_a_share_of_what_motion_needs_where_nobody_measured_torques(geared):
    signals = diagnosed.conditioned(geared, targets_alone(1))[0]
    errors = nuisance_parameters(signals.subject, signals.step)
    place = next(
        i
        for i, e in enumerate(errors)
        if (e.effect, e.location, e.parameter) == ("controller_gain", "hip", 0)
    )
    found = traces(signals, errors)[place]["motion"][:, 0]
    wanted = -errors[place].spread * (
        signals.rigid[:, 0] + robots.GAINS[0, 1] * signals.velocity[:, 0]
    )
    np.testing.assert_allclose(np.abs(found), np.abs(wanted), atol=1e-9)


def test_speeds_that_controllers_know_late_show_where_their_damping_asks_for_torque(geared):
    log = targets_alone(1)
    signals = diagnosed.conditioned(geared, log)[0]
    subject, (stiffness, damping) = signals.subject, robots.GAINS.T
    late = 0.005

    def found(signals):
        errors = nuisance_parameters(signals.subject, signals.step)
        place = next(i for i, e in enumerate(errors) if e.effect == FILTERED)
        return {
            residual_name: rows * late / errors[place].spread
            for residual_name, rows in traces(signals, errors)[place].items()
        }

    unlogged = found(signals)
    assert set(unlogged) == {"motion"}
    np.testing.assert_allclose(
        unlogged["motion"], -late * damping * signals.acceleration, atol=1e-9
    )
    asked = stiffness * (signals.target - signals.position) - damping * (
        signals.velocity - late * signals.acceleration
    )
    commands = (
        asked @ subject.motor_from_joint.T / subject.motor_scale.get("motor_torque_command", 1.0)
    )
    columns = [np.interp(log.time, signals.time, command) for command in commands.T]
    named = {
        f"motor_torque_command/{motor}": column
        for motor, column in zip(subject.motors, columns, strict=True)
    }
    logged = diagnosed.conditioned(geared, log.changed(signals={**log.signals, **named}))[0]
    told, left = found(logged)["control"], logged.residual["control"]
    use = slice(100, -100)
    assert np.nanstd((left - told)[use]) < 0.3 * np.nanstd(left[use])
    supplied = replace(signals, subject=replace(subject, supply=np.full(len(subject.motors), 12.0)))
    assert not np.any(
        list(found(supplied).values())
    )  # without current loops all damping is the motors' own


def test_a_load_is_weighed_by_targets_and_gains_alone(geared):
    logs = [targets_alone(seed, load=0.5, session="today") for seed in (1, 2)]
    healthy = [targets_alone(seed, session="before") for seed in (3, 4)]
    found = diagnose(geared, logs, healthy, threads=1)
    (cause,) = found.causes
    assert cause.location == "shank"
    assert cause.effect in {"payload", "link_mass"}
    assert cause.parameters["mass"].value == pytest.approx(0.5, rel=0.04)


def test_a_joint_without_a_drive_has_no_belt(tmp_path):
    path = tmp_path / "passive.xml"
    path.write_text(
        robots.GEARED.replace('<motor name="b" joint="knee" gear="-6" ctrlrange="-8 8"/>', "")
    )
    log = robots.geared_run("joint", ("hip", "knee"))
    signals = diagnosed.conditioned(path, robots.without(log, "motor_velocity"))[0]
    assert signals.subject.passive.tolist() == [False, True]
    belts = [
        one.location
        for one in nuisance_parameters(signals.subject, signals.step)
        if one.effect == "stiff_belt"
    ]
    assert belts == ["hip"]


def test_forces_that_are_told_too_large_show_as_said(biped_runs):
    log, share = biped_runs["standing"], 0.02
    larger = {
        c: v * (1 + share) for c, v in log.signals.items() if c.startswith("contact_force/left")
    }
    assert larger
    subject = load_subject(None, [log])
    right, wrong = (
        condition(one, subject) for one in (log, log.changed(signals={**log.signals, **larger}))
    )
    place = next(
        e
        for e in nuisance_parameters(subject, right.step)
        if (e.effect, e.location) == (FORCES_SCALED, "left_foot")
    )
    (found,) = traces(right, [place])
    for residual_name, trace in found.items():
        moved = (wrong.residual[residual_name] - right.residual[residual_name])[right.valid]
        expected = trace[right.valid] * share / place.spread
        np.testing.assert_allclose(
            np.abs(moved), np.abs(expected), atol=0.02 * np.abs(expected).max()
        )
        assert np.abs(expected).max() > 0.01
    assert set(found) == {"motion", "base"}
