"""States of a floating base from which replays start, on a biped that presses its feet apart."""

from __future__ import annotations

import dataclasses

import numpy as np

from hyperleg_design.gap.model.pads import pad_points
from hyperleg_design.gap.playback.base_states import base_states


def ticks_of(signals):
    return np.flatnonzero((signals.time > 0.6) & (signals.time < 2.5))[::40]


def unknown(signals, **fields):
    base = dataclasses.replace(
        signals.base, **{name: np.full_like(getattr(signals.base, name), np.nan) for name in fields}
    )
    return dataclasses.replace(signals, base=base)


def test_what_was_logged_is_the_state(standing):
    signals = standing()
    ticks = ticks_of(signals)
    pose, velocity = base_states(signals, ticks)
    np.testing.assert_array_equal(pose[:, :3], signals.base.position[ticks])
    np.testing.assert_allclose(np.linalg.norm(pose[:, 3:], axis=1), 1.0)
    np.testing.assert_array_equal(velocity[:, 3:], signals.base.angular_velocity[ticks])


def test_velocities_before_a_tick_lack_its_acceleration(standing):
    """The change of the velocity over half a step is half a step of acceleration."""
    signals = standing()
    ticks, half = ticks_of(signals), 0.5 * signals.step
    now, before = base_states(signals, ticks)[1], base_states(signals, ticks, half)[1]
    spin = signals.base.angular_acceleration[ticks]
    np.testing.assert_allclose(now[:, 3:] - before[:, 3:], half * spin, atol=1e-12)
    force = np.einsum(
        "tij,tj->ti", signals.base.rotation[ticks], signals.base.specific_force[ticks]
    )
    felt = (now[:, :3] - before[:, :3]) / half - signals.subject.gravity
    np.testing.assert_allclose(felt, force, atol=1e-9)


def test_an_unknown_height_puts_the_lowest_pad_on_the_floor(standing):
    signals = standing()
    ticks = ticks_of(signals)
    pose, _ = base_states(unknown(signals, position=None), ticks)
    rotation = signals.base.rotation[ticks]
    points = np.einsum(
        "tij,tpj->tpi", rotation, pad_points(signals.subject, signals.position[ticks], rotation)
    )
    np.testing.assert_allclose(points[..., 2].min(1) + pose[:, 2], 0.0, atol=1e-12)
    measured = signals.base.position[ticks, 2]
    np.testing.assert_allclose(pose[:, 2], measured, atol=3e-3)  # the ground gives way a little


def test_an_unknown_velocity_is_that_of_a_foot_at_rest(standing):
    signals = standing()
    ticks = ticks_of(signals)
    guessed = base_states(unknown(signals, linear_velocity=None), ticks)[1]
    known = base_states(signals, ticks)[1]
    np.testing.assert_allclose(guessed[:, :3], known[:, :3], atol=0.02)
