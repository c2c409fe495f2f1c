from dataclasses import replace

import diagnosed
import numpy as np
import pytest
import robots
from scipy.signal import butter, sosfilt

from hyperleg_design.gap.inference.detectors.ringing import ringing
from hyperleg_design.gap.inference.rules import PosteriorRules
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.signals.filtering import filtered_log

LOUD = PosteriorRules.ringing


def shaken(seed, size, motor="m_back"):
    """A healthy robot one of whose motors shakes at all frequencies."""
    log = diagnosed.run("healthy", seed, session=f"run {seed}")
    channel = f"motor_torque/{motor}"
    shaking = np.random.default_rng([5, seed]).normal(0, size, len(log.time))
    return log.changed(signals={**log.signals, channel: log.column(channel) + shaking})


@pytest.fixture(scope="module")
def filtered(robot_files):
    def logs(*runs):
        return [filtered_log(one) for one in diagnosed.conditioned(robot_files["coupled"], *runs)]

    return logs


def test_healthy_joints_do_not_ring(filtered):
    runs = filtered(*(diagnosed.run("healthy", seed) for seed in range(4)))
    assert ringing(runs[:2], runs[2:], LOUD) == {}
    assert ringing(runs[:2], (), LOUD) == {}


def test_joints_that_shake_in_a_log_under_test_ring(filtered):
    quiet = filtered(*(shaken(seed, 0.01) for seed in (2, 3)))
    loud = filtered(*(shaken(seed, 0.2) for seed in (0, 1)))
    over = ringing(loud, quiet, LOUD)
    assert over
    times = [heard.times for heard in over.values()]
    assert times == sorted(times, reverse=True)
    assert all(np.sqrt(LOUD) < each < 25 for each in times)
    assert over.keys() <= ringing([*loud[:1], *quiet[:1]], quiet[1:], LOUD).keys()
    assert ringing(quiet, loud, LOUD) == {}


def test_the_loudest_frequency_is_that_of_the_resonance(filtered):
    """Noise that a resonance at 30 Hz amplifies, as a link that swings on its belt."""

    def swinging(seed, size):
        log = diagnosed.run("healthy", seed, session=f"run {seed}")
        channel = "motor_torque/m_back"
        band = butter(1, (27.0, 33.0), "band", fs=1 / log.step, output="sos")
        noise = np.random.default_rng([6, seed]).normal(0, 1, len(log.time))
        shaking = size * sosfilt(band, noise) + 0.005 * noise
        return log.changed(signals={**log.signals, channel: log.column(channel) + shaking})

    over = ringing(filtered(swinging(0, 3.0)), filtered(swinging(1, 0.0)), LOUD)
    assert over
    assert all(27 < heard.frequency < 33 for heard in over.values())


def test_the_joint_that_moves_at_that_frequency_is_known(filtered):
    def moving(seed, size):
        log = shaken(seed, 0.2 if size else 0.01)
        swing = size * np.sin(2 * np.pi * 30 * log.time)
        return log.changed(
            signals={**log.signals, "position/knee": log.column("position/knee") + swing}
        )

    over = ringing(filtered(moving(0, 1e-3)), filtered(moving(1, 0.0)), LOUD)
    assert over
    near = [heard for heard in over.values() if 25 < heard.frequency < 36]
    assert all(heard.mover == "knee" and heard.moves > 5 for heard in near)
    assert near


def test_a_rotor_that_rattles_against_its_joint_is_heard(robot_files):
    """At one frequency: a line, which the median over frequencies does not see."""

    def run(seed, size):
        log = robots.geared_run("joint", ("hip", "knee"), seed=seed, session=f"run {seed}")
        channel = "motor_velocity/hip"
        rattle = size * np.sin(2 * np.pi * 38 * log.time)
        return log.changed(signals={**log.signals, channel: log.column(channel) + rattle})

    runs = [run(1, 2.0), run(2, 0.0), run(3, 0.0)]
    loud, *quiet = (
        filtered_log(one) for one in diagnosed.conditioned(robot_files["geared"], *runs)
    )
    (place, heard), *others = ringing([loud], quiet, LOUD).items()
    assert place == ("transmission", "hip")
    assert 37 < heard.frequency < 39
    assert not others
    assert ringing(quiet[:1], quiet[1:], LOUD) == {}


def test_a_robot_that_rings_is_not_said_to_be_healthy(robot_files):
    logs = [shaken(seed, 0.5) for seed in (0, 1)]
    references = [shaken(seed, 0.005).changed(name=f"reference_{seed}") for seed in (2, 3)]
    result = diagnose(robot_files["coupled"], logs, references, threads=1)
    assert result.verdict == "unknown"
    assert any(shape["shape"] == "ringing" for shape in result.residual_shape)


def test_motion_up_to_the_rate_of_a_log_is_no_ringing(filtered):
    """Where nothing is above the motion, what looks loud there is the motion itself."""
    quiet, loud = filtered(shaken(2, 0.01), shaken(0, 0.2))
    assert ringing([loud], [quiet], LOUD)
    highest = 0.3 / (1.3 * loud.signals.step)
    filled = replace(loud, rows=tuple(replace(row, cutoff=1.01 * highest) for row in loud.rows))
    assert ringing([filled], [quiet], LOUD) == {}
    assert ringing([filled, loud], [quiet], LOUD) == ringing([loud], [quiet], LOUD)
