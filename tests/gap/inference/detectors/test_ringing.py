import diagnosed
import numpy as np
import pytest

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
    assert list(over.values()) == sorted(over.values(), reverse=True)
    assert all(np.sqrt(LOUD) < times < 25 for times in over.values())
    assert over.keys() <= ringing([*loud[:1], *quiet[:1]], quiet[1:], LOUD).keys()
    assert ringing(quiet, loud, LOUD) == {}


def test_a_robot_that_rings_is_not_said_to_be_healthy(robot_files):
    logs = [shaken(seed, 0.5) for seed in (0, 1)]
    references = [shaken(seed, 0.005).changed(name=f"reference_{seed}") for seed in (2, 3)]
    result = diagnose(robot_files["coupled"], logs, references, threads=1)
    assert result.verdict == "unknown"
    assert any(shape["shape"] == "ringing" for shape in result.residual_shape)
