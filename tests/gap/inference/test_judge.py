from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.judge import (
    CHATTERS,
    INWARD,
    MISSING,
    NEGATIVE,
    OUTERMOST,
    PER_PARAMETER,
    RARE,
    Judge,
    plausible,
    rank,
)
from hyperleg_design.gap.inference.screen import linearise
from hyperleg_design.gap.inference.thresholds import load_thresholds


@pytest.fixture(scope="module")
def judge(viscous_ready):
    return Judge(viscous_ready.base, load_thresholds(), 1)


@pytest.fixture(scope="module")
def right(judge, knee_friction):
    return judge.model([knee_friction])


@pytest.fixture(scope="module")
def weak_motor(judge):
    samples = judge.base.samples
    motor = samples.filtered_logs[0].signals.subject.motors[0]
    return judge.model(
        [linearise(samples, EFFECTS["torque_constant"], motor, EFFECTS["torque_constant"].nulls)]
    )


def test_nothing_closes_nothing_and_the_cause_nearly_all(judge, right):
    rows = judge.excess_rows(right)
    assert judge.closed(judge.nothing.held, rows, judge.nothing.held) == pytest.approx(
        0.0, abs=1e-9
    )
    assert judge.closed(right.held, rows, right.held) > 0.9
    assert right.gain > judge.thresholds.evident


def test_a_trace_is_as_large_as_what_leaving_it_out_leaves(judge, right):
    shown, bare = judge.shown(right, 0), judge.rows(right.held.bare)
    knee = int(np.argmax(shown))
    assert judge.base.samples.rows[knee % len(judge.base.samples.rows)].name == "knee"
    assert shown[knee] == pytest.approx(bare[knee], rel=0.3)


def test_what_is_under_the_floor_is_no_evidence(judge, right, knee_friction):
    """The same data over a floor a hundred and fifty times as high: a model foretells them as much
    better, but all of it is under that floor.
    """
    base, high = judge.base, 150.0
    samples = replace(base.samples, floor=high * base.samples.floor)
    noisy = Judge(
        replace(base, samples=samples, errors=base.errors / high, value=base.value / high),
        judge.thresholds,
        1,
    )
    faint = noisy.model([knee_friction])
    assert right.over > 0.6 * right.gain
    errors = (
        noisy.nothing.fit.implausible - faint.fit.implausible
    )  # which explain it otherwise, and are unlikely over any floor
    assert faint.over - errors < judge.thresholds.evident < faint.gain - errors


def test_every_block_once_is_all_blocks(judge, right):
    rows = judge.excess_rows(right)
    drawn = np.stack([np.ones(judge.base.blocks), np.eye(judge.base.blocks)[0]])
    gaps = judge.gap(right.held.bare, rows, drawn)
    assert gaps[0] == pytest.approx(float(judge.gap(right.held.bare, rows)))
    assert gaps[1] != pytest.approx(gaps[0])


def test_odds_count_what_is_fitted_and_not_what_is_chosen(right, weak_motor):
    assert plausible(right) == pytest.approx(-PER_PARAMETER)
    assert weak_motor.causes[0].shape.tolist() == [False, True]
    assert plausible(weak_motor) == pytest.approx(-PER_PARAMETER)
    rarer = replace(weak_motor, causes=(replace(weak_motor.causes[0], effect="voltage_sag"),))
    assert rank(rarer) == pytest.approx(rank(weak_motor) + RARE["voltage_sag"])


def test_a_choice_is_told_as_it_was_made(judge, weak_motor):
    samples = judge.base.samples
    effect, motor = EFFECTS["torque_constant"], samples.filtered_logs[0].signals.subject.motors[0]
    read = judge.model([linearise(samples, effect, motor, np.array([1.0, 1.0]))])
    assert read.values(0)[1] == 1.0
    assert weak_motor.values(0)[1] == 0.0


def test_rows_that_are_known_for_a_moment_do_not_count(judge, right, viscous_ready):
    samples = viscous_ready.base.samples
    assert judge.present.all()
    knee = next(
        i for i, r in enumerate(samples.rows) if r.name == "knee" and r.residual_name == "motion"
    )
    filtered_logs = []
    for filtered_log in samples.filtered_logs:
        mask = filtered_log.mask.copy()
        mask[knee, 20:] = False
        filtered_logs.append(replace(filtered_log, mask=mask))
    short = Judge(
        replace(viscous_ready.base, samples=replace(samples, filtered_logs=tuple(filtered_logs))),
        load_thresholds(),
        1,
    )
    assert short.present.tolist() == [i != knee for i in range(len(samples.rows))]
    assert judge.excess_rows(right)[knee]
    assert not short.excess_rows(right)[knee]


def test_loads_hang_at_the_ends_and_odds_are_of_all_causes(judge, right):
    hung = replace(right.causes[0], effect="payload", beyond=1)
    ends, inward = (replace(right, causes=(replace(hung, beyond=n),)) for n in (0, 3))
    assert plausible(ends) - plausible(replace(right, causes=(hung,))) == pytest.approx(OUTERMOST)
    assert plausible(replace(right, causes=(hung,))) - plausible(inward) == pytest.approx(INWARD)
    both = judge.model([right.causes[0], replace(right.causes[0], location="hip")])
    assert plausible(both) == pytest.approx(2 * plausible(right))


@pytest.mark.parametrize(
    ("effect", "gone", "against"),
    [
        ("viscous_friction", 0.8, True),
        ("viscous_friction", 0.3, False),
        ("rotor_inertia", 0.8, True),
        ("payload", 0.8, False),
    ],
)
def test_hardly_any_friction_or_rotor_inertia_of_the_model_is_gone(right, effect, gone, against):
    own = replace(right.causes[0], effect=effect, low=np.array([-0.5]), beyond=1)

    def of(value):
        return replace(
            right,
            causes=(own,),
            fit=replace(right.fit, phi=(np.array([value]) - own.nulls) / own.usual),
        )

    assert of(-0.5 * gone).values(0) == pytest.approx(-0.5 * gone)
    negative = NEGATIVE if effect == "payload" else 0.0
    assert plausible(of(0.4)) - plausible(of(-0.5 * gone)) - negative == pytest.approx(
        MISSING if against else 0.0
    )


def test_loops_that_chatter_are_explained_once(judge, right):
    late = replace(right.causes[0], unsettling=True)
    one, both = (judge.model([late, *more]) for more in ((), (replace(late, location="hip"),)))
    assert plausible(one) == pytest.approx(plausible(right) + CHATTERS)
    assert plausible(both) == pytest.approx(2 * plausible(right) + CHATTERS)


def test_rows_are_a_causes_own_where_it_shows_and_no_episodes_are(judge, right):
    own = judge.own(right, 0)
    assert [judge.base.samples.rows[r].name for r in np.flatnonzero(own)] == ["knee"]
