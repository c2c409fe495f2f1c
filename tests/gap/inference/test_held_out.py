from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.base import number_of
from hyperleg_design.gap.inference.fit import Design
from hyperleg_design.gap.inference.held_out import doubt, predict, untold
from hyperleg_design.gap.inference.samples import BLOCKS, LOGS
from hyperleg_design.gap.inference.screen import linearise


@pytest.mark.parametrize("way", [BLOCKS, LOGS])
def test_data_that_were_held_out_are_better_predicted_with_the_true_cause(
    viscous_ready, knee_friction, way
):
    nothing = predict(Design(viscous_ready.base), way)
    held = predict(Design(viscous_ready.base, [knee_friction]), way)
    assert held.total > nothing.total + 20
    assert held.square.sum() < 0.3 * nothing.square.sum()
    assert (
        held.bare.shape
        == held.square.shape
        == (viscous_ready.base.blocks, viscous_ready.base.samples.groups)
    )


def test_without_causes_nothing_is_left_out(viscous_ready):
    held = predict(Design(viscous_ready.base))
    assert np.array_equal(held.bare, held.square)
    assert held.total == pytest.approx(held.likelihood.sum())


def test_a_pointless_cause_gains_nothing(viscous_ready):
    other = linearise(viscous_ready.base.samples, EFFECTS["joint_spring"], "hip", np.zeros(2))
    assert (
        predict(Design(viscous_ready.base, [other])).total
        < predict(Design(viscous_ready.base)).total + 8
    )


def test_a_fold_and_all_but_it_are_everything(viscous_ready):
    base = viscous_ready.base
    whole = number_of(base, BLOCKS, None, True)
    assert np.allclose(number_of(base, BLOCKS, 2, True) + number_of(base, BLOCKS, 2, False), whole)
    assert whole.sum() == pytest.approx(base.samples.share.sum())


@pytest.mark.parametrize("way", [BLOCKS, LOGS])
def test_what_others_leave_open_is_what_their_priors_would_foretell(viscous_ready, way):
    """Against a direct computation, of one sample of each fold: its errors' covariance given all
    samples of the other folds.
    """
    base = viscous_ready.base
    samples, design = base.samples, Design(base)
    found = doubt(base, way)
    scale = design.fit().scale
    for fold in range(samples.folds(way)):
        inside = samples.fold[way][samples.part] == fold
        one = int(np.flatnonzero(inside)[0])
        session = samples.session[samples.part]
        weight = 1 / np.minimum(design.fit(way, fold, scale, rounds=2).scale, 1.0)
        others = base.errors[:, ~inside & (session == session[one])]
        weighed = others * weight[samples.group[~inside & (session == session[one])]]
        covariance = np.linalg.inv(weighed @ others.T + base.prior.precision)
        mine = base.errors[:, one] / np.sqrt(samples.share[one])
        assert found[one] == pytest.approx(mine @ covariance @ mine, rel=1e-6)
    assert np.all(found >= 0)


def test_a_row_that_other_blocks_pin_down_is_hardly_open(viscous_ready):
    base = viscous_ready.base
    found = doubt(base)
    prior = (
        np.einsum("ps,pq,qs->s", base.errors, base.prior.covariance, base.errors)
        / base.samples.share
    )
    assert found.mean() < 0.3 * prior.mean()


def test_other_logs_tell_a_cause_that_they_show_and_no_other(viscous_ready, knee_friction):
    samples = viscous_ready.base.samples
    design = Design(viscous_ready.base, [knee_friction])
    assert (untold(design, design.fit(), LOGS) < 0.2).all()
    warm = samples.fold[LOGS][samples.part] == 0
    alone = Design(
        viscous_ready.base, [replace(knee_friction, columns=knee_friction.columns * warm)]
    )
    found = untold(alone, alone.fit(), LOGS)
    assert found[0] > 0.5, "no other log shows it"
    assert (found[1:] == 0).all(), "it leaves nothing there"
