"""A robot whose file has no friction, as most URDFs: its references show how much there is."""

import pytest
import robots

from hyperleg_design.gap.pipeline.diagnose import diagnose

BARE = robots.SERVOS.replace('axis="0 1 0"', 'axis="0 0 1"')
for words in ('frictionloss="0.5"', 'frictionloss="0.4"', 'damping="0.5"', 'damping="0.4"'):
    BARE = BARE.replace(words, "")


def log(times, seed, session):
    """Of a robot whose hip rubs some times as much as on the first day."""
    hip = f'name="hip" frictionloss="{2.0 * times}" damping="{1.5 * times}"'
    knee = 'name="knee" frictionloss="1" damping="0.6"'
    rubbing = BARE.replace('name="hip"', hip, 1).replace('name="knee"', knee, 1)
    moved = robots.servo_run(rubbing, robots.waves(2, [0.8, 0.8], seed=seed), 16.0, session=session)
    return robots.noisy(moved, seed)


@pytest.mark.slow
def test_friction_of_two_kinds_that_doubles_is_no_change_of_motor_and_ratio(tmp_path):
    file = tmp_path / "bare.xml"
    file.write_text(BARE)
    before = [log(1, 0, "first"), log(1, 1, "second")]
    found = diagnose(file, [log(2, 0, "now")], reference=before, threads=1)
    assert found.verdict == "explained"
    sizes = {cause.effect: next(iter(cause.parameters.values())) for cause in found.causes}
    assert set(sizes) == {"coulomb_friction", "viscous_friction"}
    assert {cause.location for cause in found.causes} == {"hip"}
    assert sizes["coulomb_friction"].low <= 2.0 <= sizes["coulomb_friction"].high
    assert sizes["viscous_friction"].low <= 1.5 <= sizes["viscous_friction"].high
