import numpy as np
import pytest
import robots

from hyperleg_design.errors import InputError
from hyperleg_design.gap.playback.replay import best_input, replay
from hyperleg_design.gap.playback.windows import Windows
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture(scope="module")
def signals(robot_files, runs):
    return {
        name: condition(log, load_subject(robot_files[name], [log])) for name, log in runs.items()
    }


def rms(values):
    return np.sqrt(np.nanmean(values**2, (0, 1, 2)))


@pytest.mark.parametrize(("name", "worst"), [("pendulum", 1e-4), ("coupled", 2e-3), ("arm", 3e-3)])
def test_torque_replays_reproduce_the_simulation(signals, name, worst):
    one = signals[name]
    found = replay(one, follow="torque")
    position, velocity = found.errors(one)
    assert (rms(position) < worst).all()
    assert (rms(velocity) < 12 * worst).all()
    np.testing.assert_allclose(found.torque[0, :, 0], one.believed[found.windows.start], atol=1e-9)


def test_logs_of_torque_sensors_behind_gears_are_replayed_by_commands(robot_files, runs):
    log = robots.with_torque_sensors(runs["coupled"])
    one = condition(log, load_subject(robot_files["coupled"], [log]))
    assert best_input(one) == "command"
    targets = {f"position_target/{joint}": log.column(f"position/{joint}") for joint in log.joints}
    aimed = log.changed(signals=log.signals | targets)  # whose gains nobody declares
    assert best_input(condition(aimed, load_subject(robot_files["coupled"], [aimed]))) == "command"
    for follow in ("", "torque"):
        position, _ = replay(one, follow=follow).errors(one)
        assert (rms(position) < 2e-3).all()


def test_finer_steps_come_nearer(signals, monkeypatch):
    one, errors = signals["pendulum"], []
    for step in (0.005, 0.0005):
        monkeypatch.setattr("hyperleg_design.gap.playback.replay.LONGEST_STEP", step)
        errors.append(rms(replay(one, follow="torque").errors(one)[0])[0])
    coarse, fine = errors
    assert fine < coarse < 1e-3


def test_stiff_dry_friction_does_not_chatter(tmp_path):
    """A light joint with friction of a hundred times what a step can stand explicitly comes to
    rest, and stays.
    """
    text = robots.PENDULUM.replace(
        'armature="0.003"', 'armature="0.0001" frictionloss="0.3"'
    ).replace('damping="0.02"', "")
    (tmp_path / "dry.xml").write_text(text)
    log = robots.servo_run(text, robots.waves(1, 0.2), 3.0)
    one = condition(log, load_subject(tmp_path / "dry.xml", [log]))
    velocity = replay(one, follow="torque").velocity[0]
    settled = velocity[:, velocity.shape[1] // 2 :]
    assert np.abs(np.diff(settled, axis=1)).max() < 0.02
    assert np.sqrt(np.mean(settled**2)) < 0.02


def test_bad_requests(signals):
    with pytest.raises(InputError, match="expects one of"):
        replay(signals["pendulum"], follow="wishes")
    with pytest.raises(InputError, match="is not in this log"):
        replay(signals["pendulum"], follow="target")


def test_diverged_simulations_become_unknown(robot_files, runs):
    """Torque beyond all reason in one window leaves the other windows alone."""
    import dataclasses

    one = condition(runs["pendulum"], load_subject(robot_files["pendulum"]))
    believed = one.believed.copy()
    believed[300:400] = 1e12
    found = replay(
        dataclasses.replace(one, believed=believed),
        windows=Windows(np.array([100, 310]), 50),
        follow="torque",
    )
    assert np.isfinite(found.position[0, 0]).all()
    assert not np.isfinite(found.position[0, 1]).all()


INERTIA = 'mass="0.8" diaginertia="0.008 0.008 0.001"/>'
"""Of the rig's shank."""


@pytest.fixture(scope="module")
def altered(robot_files):
    """The coupled rig with another knee damping, rotor, and mass than its file says, one at a
    time.
    """
    base = robots.COUPLED
    texts = {
        "viscous_friction": base.replace(
            'axis="0 1 0" damping="0.03"', 'axis="0 1 0" damping="0.33"'
        ),
        "rotor_inertia": base.replace(
            'name="front" armature="0.002"', 'name="front" armature="0.004"'
        ),
        "payload": base.replace(
            INERTIA, f'{INERTIA}<body><geom size="0.001" mass="0.5" pos="0 0 -0.2"/></body>'
        ),
        "encoder_offset": base + " ",
    }
    found = {}
    for name, text in texts.items():
        assert text != base
        log = robots.servo_run(text, robots.waves(2, [1.0, 1.0]), 5.0)
        if name == "encoder_offset":
            log = log.changed(
                signals={**log.signals, "position/knee": log.column("position/knee") + 0.1}
            )
        found[name] = condition(log, load_subject(robot_files["coupled"], [log]))
    return found


@pytest.mark.parametrize(
    ("effect", "location", "values"),
    [
        ("viscous_friction", "knee", {"damping": 0.3}),
        ("rotor_inertia", "m_front", {"inertia": 0.002}),
        ("encoder_offset", "knee", {"offset": 0.1}),
        ("payload", "shank", {"mass": 0.5, "com_z": -0.2}),
    ],
)
def test_the_right_change_closes_the_gap_in_position(altered, effect, location, values):
    one = altered[effect]
    found = replay(one, ({}, {(effect, location): values}), follow="torque")
    position, _ = found.errors(one)
    before, after = (np.sqrt(np.nanmean(e**2)) for e in position)
    assert after < 0.1 * before
