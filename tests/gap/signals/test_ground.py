"""The residual of the ground, on a biped that stands, bends its knees and presses its feet apart in
MuJoCo.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from grounds import late, rms

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.signals.ground import footings, ground_residual


def test_the_nominal_ground_explains_a_nominal_log(standing_biped, standing):
    signals = standing()
    residual = late(signals, signals.residual["ground"])
    assert residual.shape[1] == 6
    weight = float(standing_biped.model.body_subtreemass[1]) * 9.81
    assert rms(residual[:, [0, 1, 3, 4]]) < 0.01 * weight
    assert rms(residual[:, [2, 5]]) < 0.1 * weight / 2  # MuJoCo's contacts resist acceleration too
    assert np.nansum(late(signals, signals.contact)[..., 2].mean(0)) == pytest.approx(
        weight, rel=0.03
    )


def test_what_creeps_or_lands_does_not_slide(standing_biped, standing):
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


def test_without_forces_there_is_no_balance(standing):
    signals = dataclasses.replace(standing(), contact=None)
    assert footings(signals) == ()
    assert ground_residual(signals) is None
    assert effect("ground_friction").trace(signals, "left_foot", np.array([[0.5]])) == {}
