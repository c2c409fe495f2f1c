from dataclasses import replace

import numpy as np
import pytest
import robots

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject

QUANTUM = 1.5e-3
"""Of position sensors that came to hand [rad]."""


def share(signals, residual_name="motion"):
    """Root mean square of a residual over that of the believed joint torque, by joint."""
    torque = signals.believed @ signals.subject.joint_from_motor.T
    residual = signals.residual[residual_name][signals.valid]
    return np.sqrt(np.nanmean(residual**2, 0)) / np.sqrt(np.mean(torque[signals.valid] ** 2, 0))


@pytest.mark.parametrize(
    ("name", "clean", "rough"),
    [("pendulum", 1e-4, 0.02), ("arm", 0.02, 0.02), ("coupled", 1e-3, 0.08)],
)
def test_motion_balance_of_a_simulated_robot_vanishes(robot_files, runs, name, clean, rough):
    log = runs[name]
    assert share(condition(log, load_subject(robot_files[name], [log]))).max() < clean
    rounded = robots.quantised(log, QUANTUM)
    assert share(condition(rounded, load_subject(robot_files[name], [rounded]))).max() < rough


def test_behind_gears_that_torque_sensors_see_both_balances_vanish(robot_files, runs):
    log = robots.with_torque_sensors(runs["coupled"])
    signals = condition(log, load_subject(robot_files["coupled"], [log]))
    assert signals.behind_gears.all()
    assert signals.sensed_behind.all()
    held = log.stack("joint_torque", ("hip", "knee"))
    for residual, load in (
        (signals.residual["motion"], held),
        (signals.resisting, held),
        (signals.residual["drive"], signals.command),
    ):
        assert np.nanstd(residual[signals.valid]) < 5e-3 * np.std(load)
    before = signals.before_sensors[signals.valid]
    drive = signals.residual["drive"][signals.valid] - before
    assert np.std(before) > 10 * np.nanstd(drive + before)


def test_without_commands_torque_sensors_tell_nothing_of_drives(robot_files, runs):
    log = robots.without(robots.with_torque_sensors(runs["coupled"]), "motor_torque_command")
    signals = condition(log, load_subject(robot_files["coupled"], [log]))
    assert "drive" not in signals.residual
    assert np.isnan(signals.resisting).all()
    assert any("hip, knee: without commands" in note for note in signals.notes)


def test_torques_of_motors_count_before_those_of_sensors_at_their_joints(robot_files, runs):
    log = robots.with_torque_sensors(runs["coupled"])
    both = log.changed(signals=runs["coupled"].signals | log.signals)
    signals = condition(both, load_subject(robot_files["coupled"], [both]))
    assert signals.behind_gears is None
    np.testing.assert_allclose(signals.residual["drive"], 0, atol=1e-9)


def test_a_torque_sensor_at_no_joint_is_refused(robot_files, runs):
    log = runs["coupled"].changed(metadata=Metadata(torque_sensors=("elbow",)))
    with pytest.raises(InputError, match="torque_sensors = 'elbow': is no joint"):
        condition(log, load_subject(robot_files["coupled"]))


def test_drive_balance_of_a_servo_is_nothing(robot_files, runs):
    log = runs["arm"]
    signals = condition(log, load_subject(robot_files["arm"], [log]))
    np.testing.assert_allclose(signals.residual["drive"], 0, atol=1e-9)


def test_a_joint_that_nothing_drives_has_no_residual_of_a_drive(tmp_path):
    path = tmp_path / "passive.xml"  # nothing drives the knee
    path.write_text(
        robots.GEARED.replace('<motor name="b" joint="knee" gear="-6" ctrlrange="-8 8"/>', "")
    )
    log = robots.without(robots.geared_run("joint", ("hip", "knee")), "motor_velocity")
    log = robots.without(log, "motor_torque_command")
    torque = log.signals["motor_torque/hip"]
    copied = log.changed(signals=log.signals | {"motor_torque_command/hip": torque})
    noisy = torque + 0.1 * np.random.default_rng(0).standard_normal(len(torque))
    measured = log.changed(signals=log.signals | {"motor_torque_command/hip": noisy})
    signals = condition(measured, load_subject(path, [measured]))
    assert np.isfinite(signals.residual["drive"][:, 0]).any()
    assert np.isnan(signals.residual["drive"][:, 1]).all()
    assert not any("repeat their commands" in note for note in signals.notes)
    signals = condition(copied, load_subject(path, [copied]))
    assert np.nanmax(np.abs(signals.residual["drive"][:, 0])) == 0
    assert np.isnan(signals.residual["drive"][:, 1]).all()
    assert any("repeat their commands" in note and "hip" in note for note in signals.notes)


def test_wrong_gains_show_in_the_drive_and_wrong_payload_in_the_motion(robot_files, runs):
    log = runs["arm"]
    wrong = log.changed(metadata=Metadata(gains={"elbow": (1500.0, 150.0)}))
    signals = condition(wrong, load_subject(robot_files["arm"], [wrong]))
    assert share(signals, "drive")[2] > 0.1
    loaded = log.changed(metadata=Metadata(payload={"flange": (2.0, 0.0, 0.0, 0.0)}))
    assert share(condition(loaded, load_subject(robot_files["arm"], [loaded])))[1] > 0.1
    # a subject made for one log fits the next, whatever that declares
    again = condition(log, load_subject(robot_files["arm"], [loaded]))
    assert share(again).max() < 0.02


def test_torques_from_currents_and_joint_torques(robot_files, runs):
    log = runs["coupled"]
    subject = load_subject(robot_files["coupled"], [log])
    torque = log.stack("motor_torque", ("m_front", "m_back"))
    kept = {c: v for c, v in log.signals.items() if c.startswith("position/")}
    current = {
        f"motor_current/{m}": torque[:, i] / 0.25 for i, m in enumerate(("m_front", "m_back"))
    }
    joint = {
        f"joint_torque/{j}": (torque @ subject.joint_from_motor.T)[:, i]
        for i, j in enumerate(subject.joints)
    }
    declared = Metadata(torque_constant={"m_front": 0.25, "m_back": 0.25})
    for signals in (
        condition(Log("c", log.time, kept | current, declared), subject),
        condition(Log("j", log.time, kept | joint), subject),
    ):
        np.testing.assert_allclose(signals.measured, torque, atol=1e-9)
        assert signals.command is None
    with pytest.raises(InputError, match="torque_constant"):
        condition(Log("c", log.time, kept | current), subject)


def test_targets_with_gains_stand_in_for_torques(robot_files, runs):
    log = runs["arm"]
    kept = {c: v for c, v in log.signals.items() if not c.startswith("motor_torque/")}
    signals = condition(Log("t", log.time, kept), load_subject(robot_files["arm"]))
    assert signals.measured is None
    np.testing.assert_allclose(
        signals.believed, log.stack("motor_torque", ("a1", "a2", "a3", "a4", "a5", "a6")), atol=1e-6
    )
    bare = {c: v for c, v in kept.items() if c.startswith("position/")}
    with pytest.raises(InputError, match="tells the torque of no motor"):
        condition(Log("t", log.time, bare), load_subject(robot_files["arm"]))


def test_targets_that_are_kept_from_row_to_row_act_half_a_tick_late(robot_files, tmp_path):
    """A servo at 50 Hz whose torque nobody measures, with slow waves and with jumps that ask for
    more than it can give.
    """
    step, smooth = 0.02, robots.waves(1, [0.6], fast=2.0)
    path = tmp_path / "servo.xml"
    path.write_text(robots.without_missing_meshes(robots.ONE_SERVO))

    def jumping(time):
        return smooth(time) + 0.8 * (time % 2 > 1)[:, None]

    for way, size in ((smooth, 0.03), (jumping, 0.15)):
        log = robots.servo_run(
            robots.ONE_SERVO, lambda t, w=way: w(np.floor(t / step + 1e-9) * step), 12, 50
        )
        blind = robots.without(log, "motor_torque")
        left = {}
        for targets in ("", "kept", "moving"):
            one = blind.changed(metadata=Metadata(targets=targets))
            left[targets] = share(condition(one, load_subject(path, [one]))).max()
        assert left[""] == left["kept"] < size
        assert left["moving"] > 2 * left["kept"]


def test_commands_stop_at_the_nominal_limits(robot_files, runs):
    log = runs["arm"]
    kept = {c: v for c, v in log.signals.items() if not c.startswith("motor_torque/")}
    shifted = {c: v + 0.5 if c == "position_target/elbow" else v for c, v in kept.items()}
    signals = condition(Log("t", log.time, shifted), load_subject(robot_files["arm"]))
    assert signals.command[:, 2].max() > 800
    assert signals.believed[:, 2].max() == 150.0


def test_jitter_and_gaps_in_the_clock(robot_files, runs):
    log = runs["pendulum"]
    rng = np.random.default_rng(0)
    keep = np.ones(len(log.time), bool)
    keep[600:660] = False
    keep[rng.integers(0, len(keep), 40)] = False
    signals = condition(log.part(keep), load_subject(robot_files["pendulum"]))
    np.testing.assert_allclose(np.diff(signals.time), signals.step)
    assert not signals.valid[600:660].any()
    assert signals.valid[900:1200].all()
    assert share(signals).max() < 0.02


def test_a_joint_that_only_other_logs_know_has_no_rows(robot_files, runs):
    log = runs["arm"]
    part = log.changed(signals={c: v for c, v in log.signals.items() if not c.endswith("/wrist_3")})
    signals = condition(part, load_subject(robot_files["arm"], [log, part]))
    assert np.isnan(signals.residual["motion"][:, 5]).all()
    assert "wrist_3" in signals.notes[0]


def test_too_short_or_of_another_robot(robot_files, runs):
    with pytest.raises(InputError, match="too short"):
        condition(runs["arm"].part(slice(0, 10)), load_subject(robot_files["arm"]))
    with pytest.raises(InputError, match="no joint of this robot"):
        condition(runs["pendulum"], load_subject(robot_files["arm"]))


def test_units_of_the_rows(robot_files, runs):
    signals = condition(runs["coupled"], load_subject(robot_files["coupled"]))
    assert (
        signals.position.shape
        == signals.rigid.shape
        == signals.residual["motion"].shape
        == (2000, 2)
    )
    assert signals.believed.shape == (2000, 2)
    assert signals.bandwidth.shape == (2,)


def test_stops_push_with_a_force_that_nobody_knows(robot_files, runs, tmp_path):
    """Range that ends inside the motion: rows there are unknown; a range that is exceeded by far is
    none.
    """
    log = runs["pendulum"]
    position = log.column("position/swing")
    for margin, hits in ((0.05, True), (0.3, False)):
        high = position.max() - margin
        text = robots.PENDULUM.replace(
            'name="swing"', f'name="swing" limited="true" range="-200 {np.rad2deg(high)}"'
        )
        (tmp_path / "stop.xml").write_text(text)
        signals = condition(log, load_subject(tmp_path / "stop.xml"))
        np.testing.assert_array_equal(
            np.isnan(signals.residual["motion"][:, 0]),
            hits & (signals.position[:, 0] > high - 0.003),
        )


def test_the_speed_of_motors_is_the_logged_one_where_it_goes_with_the_joints(robot_files):
    log = robots.geared_run("joint", ("hip", "knee"), seed=1)
    subject = load_subject(robot_files["geared"], [log])

    def speeds(factor):
        """Of motors, logged as they are times a factor, and of their joints' motion."""
        told = {c: factor * v for c, v in log.signals.items() if c.startswith("motor_velocity/")}
        signals = condition(log.changed(signals={**log.signals, **told}), subject)
        return signals.motor_speed, signals.velocity @ subject.joint_from_motor

    own, of_joints = speeds(1.0)
    assert 0 < np.abs(own - of_joints).max() < 0.1 * np.abs(own).max()
    np.testing.assert_allclose(speeds(1.1)[0], 1.1 * own)
    np.testing.assert_allclose(speeds(3.0)[0], of_joints)  # of another unit: not used


def test_a_motor_follows_its_own_speed_down_its_line(robot_files):
    """Where a motor's speed jumps, as at an impact, only its torque sensor's error is left of its
    drive's residual.
    """
    log = robots.geared_run("joint", ("hip", "knee"), seed=1)
    spin = log.stack("motor_velocity", ("hip", "knee"))
    spin[len(spin) // 2] *= 2
    stall, free = 1.0, 1.2 * float(np.abs(spin).max())
    subject = load_subject(robot_files["geared"], [log])
    subject = replace(
        subject,
        stall_torque=np.full(2, stall),
        no_load_speed=np.full(2, free),
        torque_limit=np.full(2, 10.0),
    )
    given = np.clip(5.0, None, stall * (1 - spin / free))
    torques = {
        f"{kind}/{m}": values[:, i]
        for kind, values in {
            "motor_torque": given + 0.01,
            "motor_torque_command": np.full_like(spin, 5.0),
            "motor_velocity": spin,
        }.items()
        for i, m in enumerate(("hip", "knee"))
    }
    kept = {c: v for c, v in log.signals.items() if c.startswith(("position/", "velocity/"))}
    signals = condition(log.changed(signals=kept | torques), subject)
    np.testing.assert_allclose(signals.residual["drive"], 0.01, atol=1e-9)
