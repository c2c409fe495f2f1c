import numpy as np
import pytest

from hyperleg_design.gap.experiments.rehearsal import knows_gains, rehearsed, swung
from hyperleg_design.gap.experiments.rig_room import targets_for
from hyperleg_design.gap.experiments.trajectories import window
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture(scope="module")
def subjects(robot_files, tmp_path_factory):
    import robots

    path = tmp_path_factory.mktemp("servo") / "servo.xml"
    servo = '<position name="servo" joint="swing" kp="12" kv="0.4" forcerange="-3 3"/>'
    path.write_text(
        robots.PENDULUM.replace('<motor name="servo" joint="swing" ctrlrange="-3 3"/>', servo)
    )
    return {"servo": load_subject(str(path)), "motor": load_subject(str(robot_files["pendulum"]))}


def planned(duration=4.0):
    time = np.arange(round(200 * duration)) / 200
    return time, (0.4 * np.sin(2 * np.pi * 0.7 * time) * window(time))[:, None]


def test_closed_loop_follows_the_plan_when_targets_lead(subjects):
    subject = subjects["servo"]
    assert knows_gains(subject)
    time, position = planned()
    log = rehearsed(subject, "plan", time, targets_for(subject, position, 0.005), position)
    assert np.abs(log.column("position/swing") - position[:, 0])[20:].max() < 0.02
    signals = condition(log, subject)
    # targets that are held for 5 ms make the torque a saw of 12 Nm/rad times their steps
    saw = 12 * np.abs(np.diff(log.column("position_target/swing"))).max()
    assert np.nanmax(np.abs(signals.residual["motion"][signals.valid])) < 0.6 * saw
    assert np.nanmax(np.abs(signals.residual["drive"][signals.valid])) < 1e-9


def test_unknown_gains_mean_exact_following(subjects):
    subject = subjects["motor"]
    assert not knows_gains(subject)
    time, position = planned()
    log = rehearsed(subject, "plan", time, position, position)
    assert np.array_equal(log.column("position/swing"), position[:, 0])
    assert not log.has("position_target", "swing")
    assert np.nanmax(np.abs(condition(log, subject).residual["motion"])) < 0.05


def test_drives_off_give_no_torque_and_lose_energy(subjects):
    subject = subjects["servo"]
    time = np.arange(1600) / 200
    free = swung(subject, np.array([0.6]), time)[:, 0]
    peaks = np.abs(free[np.flatnonzero(np.diff(np.sign(np.diff(free)))) + 1])
    assert len(peaks) > 5
    assert (np.diff(peaks) < 0).all()
    target = np.full((1600, 1), np.nan)
    log = rehearsed(subject, "swing", time, target, free[:, None])
    assert np.all(log.column("motor_torque/swing") == 0)
    period = 2 * np.pi * np.sqrt((0.0006 + 0.5 * 0.01 + 0.003) / (0.5 * 9.81 * 0.1))
    turns = np.flatnonzero(np.diff(np.sign(free)))
    assert np.diff(turns).mean() / 200 * 2 == pytest.approx(period, rel=0.05)


def test_without_torque_the_log_has_none(subjects):
    time, position = planned(1.0)
    log = rehearsed(subjects["servo"], "plan", time, position, position, torque=False)
    assert not log.has("motor_torque", "swing")
