"""Traces of nuisance parameters against logs and forces that are changed as they say."""

from dataclasses import replace

import diagnosed
import numpy as np
import pytest
import robots

from hyperleg_design.gap.effects import EFFECTS, WEIGHED
from hyperleg_design.gap.effects.usual import lateness
from hyperleg_design.gap.inference.nuisance import (
    BACK_EMF,
    FILTERED,
    FORCES_LATE,
    FORCES_SCALED,
    GEARED,
    IMU_TURNED,
    SOLE,
    STEPPED,
    SWUNG,
    TARGETS_AGED,
    TARGETS_LATE,
    TOLD_LATE,
    TORQUES_LATE,
    TURNOVER,
    NuisanceParameter,
    nuisance_parameters,
)
from hyperleg_design.gap.inference.nuisance_traces import columns, traces
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.filtering import filtered_log
from hyperleg_design.gap.signals.loading import load_subject


def test_friction_under_load_is_no_share_of_the_measured_torque(signals, errors):
    rubbing = replace(signals, believed=3 * signals.believed)
    for one, now, then in zip(
        errors, traces(rubbing, errors), traces(signals, errors), strict=True
    ):
        if one.effect == "load_dependent_friction":
            np.testing.assert_array_equal(now["motion"], then["motion"])


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


@pytest.mark.parametrize("late", [False, True])
def test_torques_of_kept_targets_may_be_measured_at_either_end_of_the_step(tmp_path, late):
    """A servo at 50 Hz: a program logs the torque before it sends a target, or after."""
    step, smooth = 0.02, robots.waves(1, [0.6])
    path = tmp_path / "servo.xml"
    path.write_text(robots.without_missing_meshes(robots.ONE_SERVO))
    log = robots.servo_run(
        robots.ONE_SERVO, lambda t: smooth(np.floor(t / step + 1e-9) * step), 12, 50
    )
    (servo,) = log.names("motor_torque")
    if late:
        (joint,) = log.names("position_target")
        targets = log.column(f"position_target/{joint}")
        before = np.r_[targets[:1], targets[:-1]]
        (signals,) = diagnosed.conditioned(path, log)
        ratio = signals.subject.gains[0, 0] * signals.subject.motor_from_joint[0, 0]
        torque = log.column(f"motor_torque/{servo}") - ratio * (targets - before)
        log = log.changed(signals={**log.signals, f"motor_torque/{servo}": torque})
    (signals,) = diagnosed.conditioned(path, log)
    errors = nuisance_parameters(signals.subject, signals.step)
    place = next(i for i, e in enumerate(errors) if e.effect == TARGETS_AGED)
    age = (0.5 if late else -0.5) * step
    found = traces(signals, errors)[place]
    for residual_name in ("drive", "motion"):
        left = signals.residual[residual_name] - found[residual_name] * age / errors[place].spread
        use = slice(20, -20)
        assert np.std(left[use]) < 0.2 * np.std(signals.residual[residual_name][use])
    moving = signals.log.changed(metadata=replace(log.metadata, targets="moving"))
    (signals,) = diagnosed.conditioned(path, moving)
    assert traces(signals, errors)[place] == {}


def test_targets_that_are_late_by_themselves_are_a_usual_error(geared):
    """As the catalogue's delay of targets alone, of a millisecond."""
    signals = diagnosed.conditioned(geared, targets_alone(1))[0]
    errors = nuisance_parameters(signals.subject, signals.step)
    place = next(i for i, e in enumerate(errors) if e.effect == TARGETS_LATE)
    assert errors[place].spread == lateness(signals.step)
    found = traces(signals, errors)[place]
    late = EFFECTS["command_delay"].trace(signals, "robot", np.array([[1e-3, 1.0]]))
    assert set(found) == set(late) == {"motion"}
    expected = late["motion"][0, 20:-20] / 1e-3 * errors[place].spread
    assert np.std(found["motion"][20:-20] - expected) < 0.1 * np.std(expected)


CONSTANT, RESISTANCE, INDUCTANCE, BANDWIDTH = 0.09, 0.2, 1e-4, 2 * np.pi * 150
"""Of a motor [Nm/A, Ohm, H] and of its current loop [rad/s]."""


def current_loop(time, speed):
    """Torque that a motor with a PI loop, whose zero is at R / L, gives when none is asked for."""
    step, substeps = time[1] - time[0], 200
    current, integral, torque = 0.0, 0.0, np.zeros(len(time))
    for k in range(1, len(time)):
        for part in range(substeps):
            w = speed[k - 1] + (speed[k] - speed[k - 1]) * part / substeps
            voltage = -BANDWIDTH * (INDUCTANCE * current + RESISTANCE * integral)
            integral += current * step / substeps
            push = voltage - RESISTANCE * current - CONSTANT * w
            current += push / INDUCTANCE * step / substeps
        torque[k] = CONSTANT * current
    return torque


def test_current_loops_give_up_torque_where_motors_accelerate(geared):
    signals = diagnosed.conditioned(geared, targets_alone(1))[0]
    errors = nuisance_parameters(signals.subject, signals.step)
    place = next(i for i, e in enumerate(errors) if (e.effect, e.location) == (BACK_EMF, "hip"))
    inertia = CONSTANT**2 / (RESISTANCE * BANDWIDTH)
    found = traces(signals, errors)[place]
    assert set(found) == {"motion"}
    assert not found["motion"][:, 1].any()
    (gear,) = signals.subject.joint_from_motor[0, [0]]
    ticks = slice(200, 1200)
    lost = current_loop(signals.time[ticks], gear * signals.velocity[ticks, 0])
    expected = -gear * lost[100:]
    shown = found["motion"][ticks, 0][100:] * inertia / errors[place].spread
    assert np.std(shown - expected) < 0.1 * np.std(expected)


@pytest.mark.slow
def test_a_load_is_weighed_by_targets_and_gains_alone(geared):
    logs = [targets_alone(seed, load=0.5, session="today") for seed in (1, 2)]
    healthy = [targets_alone(seed, session="before") for seed in (3, 4)]
    found = diagnose(geared, logs, healthy, threads=1)
    (cause,) = found.causes
    assert cause.location == "shank"
    assert cause.effect in {"payload", "link_mass"}
    assert cause.parameters["mass"].value == pytest.approx(0.5, rel=0.04)


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


@pytest.fixture(scope="module")
def rubbing(signals):
    """The same log of a robot whose model has friction."""
    coulomb = np.array([0.2, 0.1])
    return replace(signals, subject=replace(signals.subject, coulomb=coulomb))


@pytest.fixture(scope="module")
def geared_log():
    return robots.geared_run("joint", ("hip", "knee"), seed=1)


def test_a_trace_is_that_of_one_spread(rubbing):
    errors = nuisance_parameters(rubbing.subject, rubbing.step)
    halved = [replace(one, spread=one.spread / 2) for one in errors]
    shown = 0
    for one, whole, half in zip(
        errors, traces(rubbing, errors), traces(rubbing, halved), strict=True
    ):
        assert set(whole) == set(half)
        for name, trace in whole.items():
            trace, part = np.nan_to_num(trace), np.nan_to_num(half[name])
            if not trace.any():
                continue
            shown += 1
            nearly = np.sum(trace * part) / np.sum(trace**2)
            assert nearly == pytest.approx(0.5, abs=0.02), one.name
            assert np.corrcoef(trace.ravel(), part.ravel())[0, 1] > 0.97, one.name
    assert shown > 20


def test_friction_that_turns_over_otherwise_is_the_same_once_a_joint_slides(rubbing):
    errors = [NuisanceParameter(TURNOVER, "knee", i, 1.0) for i in range(3)]
    sliding = np.abs(rubbing.velocity[:, 1]) > 8 * rubbing.subject.friction_speed[1]
    assert 0.1 < sliding.mean() < 1.0
    for found in traces(rubbing, errors):
        rows = found["motion"]
        assert not rows[:, 0].any()
        assert 0.02 < np.abs(rows[:, 1]).max() <= 2 * rubbing.subject.coulomb[1] + 1e-9
        slow, fast = (np.sqrt(np.mean(rows[mask, 1] ** 2)) for mask in (~sliding, sliding))
        assert fast < 0.5 * slow


def test_friction_is_stepped_as_it_is_at_even_speed(rubbing):
    stepped = [NuisanceParameter(STEPPED, "robot", 0, 0.5)]
    even = replace(rubbing, acceleration=np.zeros_like(rubbing.acceleration))
    np.testing.assert_allclose(traces(even, stepped)[0]["motion"], 0.0, atol=1e-12)
    assert np.abs(traces(rubbing, stepped)[0]["motion"]).max() > 0.1


def test_a_joint_that_does_not_chatter_has_no_friction_of_chatter(rubbing):
    assert rubbing.limit_cycle is None
    assert traces(rubbing, [NuisanceParameter(SWUNG, "knee", 0, 0.7)]) == [{}]


def test_torques_that_are_told_late_are_those_of_before(signals):
    late = 0.002
    (found,) = traces(signals, [NuisanceParameter(TORQUES_LATE, "robot", 0, late)])
    known = np.isfinite(signals.rigid).all(1) & signals.valid
    for joint in range(2):
        before, after = (
            np.interp(signals.time[known] + shift, signals.time[known], signals.rigid[known, joint])
            for shift in (-late, late)
        )
        expected = (before - after) / 2
        trace = found["motion"][known, joint]
        assert np.sqrt(np.mean((trace - expected) ** 2)) < 0.02 * np.std(expected)


@pytest.mark.parametrize("effect", [GEARED, TOLD_LATE])
def test_speeds_of_motors_that_are_told_otherwise_show_as_said(geared, geared_log, effect):
    amount = 0.01 if effect == GEARED else 0.002
    subject = load_subject(geared, [geared_log])
    name = next(c for c in geared_log.signals if c.startswith("motor_velocity/"))
    motor = name.partition("/")[2]
    speed = geared_log.column(name)
    if effect == GEARED:
        told = (1 + amount) * speed
    else:
        told = np.interp(geared_log.time - amount, geared_log.time, speed)
    right, wrong = (
        condition(log, subject)
        for log in (
            geared_log,
            geared_log.changed(signals={**geared_log.signals, name: told}),
        )
    )
    (found,) = traces(right, [NuisanceParameter(effect, motor, 0, amount)])
    moved = (wrong.residual["transmission"] - right.residual["transmission"])[right.valid]
    trace = found["transmission"][right.valid]
    place = subject.motors.index(motor)
    assert set(found) == {"transmission"}
    assert not np.delete(trace, place, 1).any()
    wrong_by = np.sqrt(np.mean((moved - trace)[:, place] ** 2))
    assert wrong_by < 0.1 * np.std(trace[:, place])


@pytest.fixture(scope="module")
def stood(biped_runs):
    """Signals of the standing biped."""
    log = biped_runs["standing"]
    return condition(log, load_subject(None, [log]))


def test_a_thicker_sole_turns_what_its_forces_push_sideways(stood):
    lift = 0.003
    (found,) = traces(stood, [NuisanceParameter(SOLE, "left_foot", 0, lift)])
    own = [
        i for i, pad in enumerate(stood.subject.pads) if stood.subject.feet[pad.foot] == "left_foot"
    ]
    force = np.nan_to_num(stood.pad_force)[:, own].sum(1)
    np.testing.assert_allclose(found["base"][:, :3], 0.0, atol=1e-9)
    moment = np.linalg.norm(found["base"][:, 3:], axis=1)
    np.testing.assert_allclose(moment, lift * np.hypot(force[:, 0], force[:, 1]), atol=1e-9)
    assert moment.max() > 1e-3
    right = [j for j, joint in enumerate(stood.subject.joints) if joint.startswith("right")]
    assert not found["motion"][:, right].any()
    assert found["motion"].any()


def test_forces_that_are_told_late_show_as_said(biped_runs, stood):
    log, late = biped_runs["standing"], 0.002
    told = {
        c: (np.interp(log.time - late, log.time, v) - np.interp(log.time + late, log.time, v)) / 2
        + v
        for c, v in log.signals.items()
        if c.startswith("contact_force/")
    }
    wrong = condition(log.changed(signals={**log.signals, **told}), stood.subject)
    (found,) = traces(stood, [NuisanceParameter(FORCES_LATE, "robot", 0, late)])
    assert set(found) == {"motion", "base"}
    inside = np.flatnonzero(stood.valid)[3:-3]
    for name, trace in found.items():
        moved = (wrong.residual[name] - stood.residual[name])[inside]
        error = np.sqrt(np.mean((np.abs(moved) - np.abs(trace[inside])) ** 2))
        assert error < 1e-6 * np.std(moved)


def test_an_imu_half_a_degree_off_is_a_usual_error_of_a_floating_base(biped_runs, geared):
    log = biped_runs["standing"]
    signals = condition(log, load_subject(None, [log]))
    errors = nuisance_parameters(signals.subject, signals.step)
    turns = [i for i, e in enumerate(errors) if e.effect == IMU_TURNED]
    assert [errors[i].parameter for i in turns] == [0, 1, 2]
    found = traces(signals, errors)
    for axis, place in enumerate(turns):
        turn = errors[place].spread * np.eye(3)[axis]
        expected = WEIGHED["turned_imu"].trace(signals, "imu", turn[None])
        assert set(found[place]) == set(expected)
        for residual_name, rows in expected.items():
            np.testing.assert_allclose(found[place][residual_name], rows[0])
    fixed = diagnosed.conditioned(geared, targets_alone(1))[0]
    errors = nuisance_parameters(fixed.subject, fixed.step)
    assert not any(error.effect == IMU_TURNED for error in errors)
