import dataclasses

import numpy as np

from hyperleg_design.gap.signals.filtering import filtered_log
from hyperleg_design.gap.signals.resting import (
    UNDERWAY,
    moving,
    moving_ticks,
    rubbing,
    sticking,
    travelled,
)
from hyperleg_design.gap.signals.sliding import presliding, sliding


def test_a_joint_at_rest_may_stick_and_a_moving_one_does_not(signals):
    found = sticking(signals)
    fast = np.abs(signals.velocity) > 0.2
    assert not np.any(found & fast)
    first = np.all(np.abs(signals.velocity[:5]) < 1e-2)
    assert not first or found[2].all()


def test_a_joint_that_creeps_may_stick_unless_it_follows_a_slow_target_or_comes_far(signals):
    slow = 0.05 * signals.time[:, None] * np.ones(2)
    creeps = dataclasses.replace(
        signals, position=slow, velocity=np.full_like(slow, 0.05), limit_cycle=None
    )
    assert not sticking(dataclasses.replace(creeps, target=slow + 0.01))[20:-20].any()
    astray = dataclasses.replace(creeps, target=np.ones_like(slow))
    far = slow > UNDERWAY * presliding(astray)
    assert sticking(astray)[~far].all()
    assert not sticking(astray)[far][20:].any()
    assert sticking(dataclasses.replace(astray, measured=None)).all()
    swing = 0.002 * np.sin(25 * signals.time)[:, None] * np.ones(2)  # to and fro at the same speed
    assert sticking(
        dataclasses.replace(
            astray, position=swing, velocity=np.gradient(swing, signals.step, axis=0)
        )
    ).all()
    assert not sticking(dataclasses.replace(creeps, target=None))[20:-20].any()


def test_a_torque_sensor_sees_friction_turn_over_before_the_joint_has_slid(signals):
    """A joint that stops for 30 ms as it turns back, too short for rest."""
    time, step = signals.time, signals.step
    phase = np.cumsum(np.where((time % 1.0) < 0.03, 0.0, 1.0)) * step
    position = 0.3 * np.cos(2 * np.pi * phase / 0.97)[:, None] * np.ones(2)
    velocity = np.gradient(position, step, axis=0)
    plain = dataclasses.replace(
        signals, position=position, velocity=velocity, limit_cycle=None, target=None
    )
    sensed = dataclasses.replace(plain, behind_gears=np.array([True, False]))
    more = sticking(sensed) & ~sticking(plain)
    assert more[:, 0].any()
    assert not more[:, 1].any()
    against = velocity * sliding(plain) < 0
    assert sticking(sensed)[against[:, 0], 0].all()
    assert not sticking(sensed)[np.abs(velocity[:, 0]) > 1.0, 0].any()


def test_way_begins_anew_at_rest_and_at_each_return():
    position = np.array([0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 1.0, 2.0])[:, None]
    rest = np.zeros_like(position, bool)
    assert travelled(position, rest)[:, 0].tolist() == [0, 1, 2, 3, 0, -1, -1, 0]
    rest[2] = True
    assert travelled(position, rest)[:, 0].tolist() == [0, 1, 0, 1, 0, -1, -1, 0]


def test_the_rest_of_a_joint_that_hardly_moves_counts_only_without_dry_friction(signals):
    known, resting, step = np.ones(1000, bool), np.arange(1000) >= 50, 0.005
    assert moving(known, resting, step, rubs=False).all()
    np.testing.assert_array_equal(moving(known, resting, step, rubs=True), ~resting)
    # a tenth of the time, in pieces of 0.1 s: too short to be told from what smoothing leaves
    pieces = np.arange(1000) % 200 >= 20
    assert not moving(known, pieces, step, rubs=True).any()
    np.testing.assert_array_equal(moving(known, pieces, step, rubs=False), ~pieces)
    half = np.arange(1000) % 40 >= 20
    for rubs in (False, True):
        np.testing.assert_array_equal(moving(known, half, step, rubs=rubs), ~half)

    still = np.ones_like(signals.position, bool)
    still[:50] = False
    dry = dataclasses.replace(
        signals, subject=dataclasses.replace(signals.subject, coulomb=np.array([0.0, 1.0]))
    )
    one = filtered_log(dry, still)
    mask = {
        row.name: m
        for row, m in zip(one.rows, one.mask, strict=True)
        if row.residual_name == "motion"
    }
    assert mask["hip"][60:].any()
    assert "knee" not in mask or not mask["knee"][50:].any()
    every = moving_ticks(dry, np.ones_like(still), still)
    assert every[:, 0].all()
    np.testing.assert_array_equal(every[:, 1], ~still[:, 1])
    # where nobody measures the torque, a servo's position error at rest is what friction holds
    told = dataclasses.replace(dry, measured=None)
    assert rubbing(told).all()
    np.testing.assert_array_equal(moving_ticks(told, np.ones_like(still), still), ~still)
