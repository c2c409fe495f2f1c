"""The residual of the ground, on a biped that stands, bends its knees and presses its feet apart in
MuJoCo.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.ground.ground_friction import ChangedGround
from hyperleg_design.gap.playback import show, standard_run
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.ground import footings, ground_residual
from hyperleg_design.gap.signals.nominal_ground import foot_bodies


@pytest.fixture(scope="module")
def biped():
    return show._subject(None, True)


@pytest.fixture(scope="module")
def standing(biped):
    """Signals of a run with alterations of the ground."""
    time = np.arange(601) * standard_run.TICK
    target = show._stand_targets(biped, time)
    kept = {}

    def signals(**changes):
        key = tuple(sorted(changes.items()))
        if key not in kept:
            alterations = (ChangedGround(foot_bodies(biped, 0), **changes),) if changes else ()
            kept[key] = condition(
                standard_run.simulated_log(biped, target, time, alterations)[1], biped
            )
        return kept[key]

    return signals


def rms(values):
    return float(np.sqrt(np.nanmean(values**2)))


def late(signals, values):
    """After the robot has come down."""
    return values[(signals.time > 0.6) & signals.valid]


def test_the_nominal_ground_explains_a_nominal_log(biped, standing):
    signals = standing()
    residual = late(signals, signals.residual["ground"])
    assert residual.shape[1] == 6
    weight = float(biped.model.body_subtreemass[1]) * 9.81
    assert rms(residual[:, [0, 1, 3, 4]]) < 0.01 * weight
    assert rms(residual[:, [2, 5]]) < 0.1 * weight / 2  # MuJoCo's contacts resist acceleration too
    assert np.nansum(late(signals, signals.contact)[..., 2].mean(0)) == pytest.approx(
        weight, rel=0.03
    )


def test_a_slippery_foot_leaves_what_the_trace_says(standing):
    signals = standing(friction=0.2)
    trace = effect("ground_friction").trace(signals, "left_foot", np.array([[1.0], [0.2]]))[
        "ground"
    ]
    assert np.nanmax(np.abs(trace[0])) < 1e-9
    residual, expected = (
        late(signals, signals.residual["ground"][:, :2]),
        late(signals, trace[1][:, :2]),
    )
    assert rms(residual) > 30.0
    assert rms(residual - expected) < 0.2 * rms(residual)
    assert np.nanmax(np.abs(trace[1][:, 3:])) < 1e-9


def test_what_creeps_or_lands_does_not_slide(biped, standing):
    """Feet of a simulated walk move at 0.05-0.25 m/s under load, with a tenth of the cone: no
    friction is that small.
    """
    foot = footings(standing())[0]
    one = np.ones(1)
    ticks = foot.settled & (foot.force[:, 2] > 100)

    def left(speed):
        moved = dataclasses.replace(
            foot, slide=np.tile([speed, 0.0], (len(foot.force), 1)), known={}
        )
        return rms((foot.force - moved.ground(one, one, one)[0])[ticks, :2])

    creeping = foot.friction * float(np.nanmax(foot.force[:, 2])) / foot.law.creep
    assert left(0.4 * creeping) < 1.0
    assert left(1.1 * creeping) > 30.0


def test_a_soft_foot_leaves_what_the_trace_says(standing):
    signals = standing(compliance=3.0)
    one = effect("ground_compliance")
    trace = one.trace(signals, "left_foot", np.array([[3.0, 1.0], [1.0, 1.0]]))["ground"]
    residual, expected = (
        late(signals, signals.residual["ground"][:, 2]),
        late(signals, trace[0][:, 2]),
    )
    assert rms(residual) > 2 * rms(late(standing(), standing().residual["ground"][:, 2]))
    assert rms(residual - expected) < 0.5 * rms(residual)
    assert np.nanmax(np.abs(trace[1])) < 1e-9


def test_without_forces_there_is_no_balance(standing):
    signals = dataclasses.replace(standing(), contact=None)
    assert footings(signals) == ()
    assert ground_residual(signals) is None
    assert effect("ground_friction").trace(signals, "left_foot", np.array([[0.5]])) == {}
