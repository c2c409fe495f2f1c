import numpy as np
import pytest
import robots

from hyperleg_design.errors import InputError
from hyperleg_design.gap.playback.replay import best_input, replay
from hyperleg_design.gap.playback.windows import short_windows, whole_log
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture(scope="module")
def signals(robot_files, runs):
    return {
        name: condition(log, load_subject(robot_files[name], [log])) for name, log in runs.items()
    }


def rms(values):
    return np.sqrt(np.nanmean(values**2, (0, 1, 2)))


@pytest.mark.slow
def test_closed_loop_replay_of_the_whole_log(signals):
    one = signals["arm"]
    assert best_input(one) == "target"
    position, _ = replay(one, windows=whole_log(one)).errors(one)
    # the simulation's targets moved on between ticks, where a replay holds them: half a tick of
    # delay
    speed = np.sqrt(np.mean(one.velocity**2, 0))
    assert (rms(position) < 1.2 * one.step / 2 * speed).all()


def test_windows_keep_off_gaps(robot_files, runs):
    keep = np.ones(2000, bool)
    keep[700:760] = False
    one = condition(runs["pendulum"].part(keep), load_subject(robot_files["pendulum"]))
    windows = short_windows(one, 0.3)
    assert one.valid[windows.ticks].all()
    assert windows.length == 60
    with pytest.raises(InputError, match="longer than any stretch"):
        short_windows(one, 60.0)


def test_gains_too_stiff_for_a_joint_without_rotor_stay_stable(tmp_path):
    """Ten times what an explicit step can stand; the joint follows its target as a stiff servo
    does.
    """
    text = robots.PENDULUM.replace('armature="0.003"', "").replace(
        'diaginertia="0.0006 0.0006 0.0001"', 'diaginertia="1e-5 1e-5 1e-5"'
    )
    text = text.replace('pos="0 0 -0.1" mass="0.5"', 'pos="0 0 -0.01" mass="0.05"')
    text = text.replace(
        '<motor name="servo" joint="swing" ctrlrange="-3 3"/>',
        '<position name="servo" joint="swing" kp="9" kv="0.5"/>',
    )
    (tmp_path / "servo.xml").write_text(text)
    log = robots.servo_run(text.replace("RK4", "implicitfast"), robots.waves(1, 0.4), 3.0)
    one = condition(log, load_subject(tmp_path / "servo.xml", [log]))
    position, _ = replay(one, windows=whole_log(one)).errors(one)
    assert rms(position)[0] < 1.5 * one.step / 2 * np.sqrt(np.mean(one.velocity**2))
