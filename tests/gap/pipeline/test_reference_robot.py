"""References of a robot that was built differently then."""

from __future__ import annotations

import diagnosed
import numpy as np
import pytest
import robots

from hyperleg_design.errors import InputError
from hyperleg_design.gap.checks.intake import prepare
from hyperleg_design.gap.pipeline.diagnose import diagnose

HEAVY = robots.COUPLED.replace('mass="0.8"', 'mass="1.6"')


def heavy_run(seed: int):
    """A log of the rig with a heavier shank that its own model knows of."""
    log = robots.servo_run(HEAVY, robots.waves(2, [1.5, 1.5], seed=seed), 12.0)
    rng = np.random.default_rng([9, seed])
    noise = {"position": 5e-5, "velocity": 5e-3, "motor_torque": 5e-3}
    signals = {
        c: v + rng.normal(0, noise[c.partition("/")[0]], len(v)) for c, v in log.signals.items()
    }
    return log.changed(signals=signals, name=f"heavy_{seed}")


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("robots")
    texts = {"light": robots.COUPLED, "heavy": HEAVY, "servos": robots.SERVOS}
    for name, text in texts.items():
        (folder / f"{name}.xml").write_text(text)
    return {name: folder / f"{name}.xml" for name in texts}


def test_each_log_is_compared_with_the_model_of_its_own_robot(files):
    before = [diagnosed.run("healthy", seed) for seed in (1, 2)]
    now = [heavy_run(3)]
    found = diagnose(files["heavy"], now, before, reference_robot=files["light"])
    assert found.verdict == "none"


def test_robots_and_logs_that_do_not_go_together_are_refused(files):
    log, other = (diagnosed.run("healthy", seed) for seed in (1, 2))
    with pytest.raises(InputError, match="needs reference logs"):
        prepare(files["heavy"], [log], reference_robot=files["light"])
    one = prepare(files["heavy"], [log], [other])
    assert one.tests[0].subject is one.references[0].subject
    servos = robots.servo_run(robots.SERVOS, robots.waves(2, [0.6, 0.8], seed=1), 2.0)
    with pytest.raises(
        InputError, match=r"has other joints than heavy|has other motors than heavy"
    ):
        prepare(files["heavy"], [log], [servos], reference_robot=files["servos"])
