"""Flexible functions against effects of the catalogue, on a pendulum to which torques are added."""

from dataclasses import replace

import numpy as np
import pytest
from pendulum import Wrong

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects import UNLISTED, WEIGHED
from hyperleg_design.gap.inference.assembly import evidence_of
from hyperleg_design.gap.inference.hypotheses.cause_prior import prior_odds
from hyperleg_design.gap.inference.linearisation import linearise
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.pipeline.diagnose import diagnose_signals

FLEXIBLE = sorted(name for name, one in WEIGHED.items() if one.flexible)
RIVALS = ("coulomb_friction", "viscous_friction", "stribeck_friction", "odd_torque")


def with_torque(signals, torque):
    """Signals of a joint that takes a torque `(t,)`, too."""
    return replace(signals, residual={"motion": signals.residual["motion"] + torque[:, None]})


@pytest.mark.parametrize(
    ("power", "verdict", "causes"),
    [(1, "explained", ["viscous_friction"]), (2, "unknown", [])],
)
def test_what_the_catalogue_has_wins_and_what_it_lacks_is_unknown(pendulum, power, verdict, causes):
    signals = pendulum(Wrong())
    speed = signals.velocity[:, 0]
    told = diagnose_signals(
        [with_torque(signals, 0.3 * np.sign(speed) * np.abs(speed) ** power)], effects=RIVALS
    )
    assert told.verdict == verdict
    assert [one.effect for one in told.causes] == causes
    assert ("odd_torque" in {one["shape"] for one in told.residual_shape}) == (power == 2)


@pytest.mark.parametrize("name", FLEXIBLE)
def test_no_answer_names_one_and_no_simulation_takes_one(pendulum, name):
    effect, subject = WEIGHED[name], pendulum(Wrong()).subject
    assert name in UNLISTED
    with pytest.raises(InputError, match="is added to no simulation"):
        effect.alteration("swing", effect.nulls, subject)
    sentences = {effect.describe(row) for row in effect.variants(pendulum(Wrong()), "swing")}
    assert len(sentences) == len(effect.inputs)
    assert all(one.startswith(effect.sentence) for one in sentences)


@pytest.mark.parametrize("name", FLEXIBLE)
def test_traces_are_sums_of_their_shapes_and_nothing_at_the_nulls(pendulum, name):
    effect, signals = WEIGHED[name], pendulum(Wrong())
    rng = np.random.default_rng(1)
    for row in effect.variants(signals, "swing"):
        settings = np.tile(row, (effect.sizes + 1, 1))
        settings[: effect.sizes, : effect.sizes] = np.eye(effect.sizes)
        settings[-1, : effect.sizes] = sizes = rng.normal(size=effect.sizes)
        found = effect.trace(signals, "swing", settings)["motion"]
        np.testing.assert_allclose(found[-1], np.tensordot(sizes, found[:-1], 1), atol=1e-9)
        assert np.isfinite(found).all()
        assert not effect.trace(signals, "swing", row[None])["motion"].any()


@pytest.mark.parametrize("name", FLEXIBLE)
def test_shapes_cost_no_prior_odds_beside_that_of_their_kind_and_the_choice_of_the_input(
    pendulum, name
):
    effect, signals = WEIGHED[name], pendulum(Wrong())
    samples = evidence_of([signals], [], InferenceRules()).samples
    row = effect.variants(signals, "swing")[0]
    cause = linearise(samples, effect, "swing", row)
    assert prior_odds(cause, row, InferenceRules()) == effect.rare
    assert effect.odds("swing", signals.subject, row) <= -np.log(len(effect.inputs))
