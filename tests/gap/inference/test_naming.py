"""Rules by which causes are named, on judges that know just what a rule asks."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnosed import in_episodes

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.judge import Judge, rank
from hyperleg_design.gap.inference.naming import (
    _visible,
    apart,
    likelier,
    shows_in_a_band,
    stands_out,
    sticks_alone,
    unshown,
    worth_adding,
    worth_naming,
)
from hyperleg_design.gap.inference.screen import linearise
from hyperleg_design.gap.inference.thresholds import load_thresholds


def of_battery(effect, unseen):
    """A cause of two sizes, of which the second is 4 at most."""
    return SimpleNamespace(
        effect=effect, unseen=unseen, high=np.array([20.0, 4.0]), shape=np.zeros(2, bool)
    )


@pytest.mark.parametrize(
    ("share", "effect", "line", "episode", "unseen", "seldom"),
    [
        (0.01, "voltage_sag", np.inf, True, False, True),
        (0.03, "voltage_sag", np.inf, True, False, False),
        (0.03, "voltage_sag", np.inf, True, True, True),
        (0.03, "voltage_sag", 3.0, True, True, False),
        (0.01, "voltage_sag", 3.0, True, False, False),
        (0.01, "voltage_sag", np.inf, False, False, False),
        (0.01, "torque_saturation", np.inf, True, False, False),
    ],
)
def test_a_weak_battery_shows_more_often_than_limits_of_healthy_drives_or_by_its_voltage(
    share, effect, line, episode, unseen, seldom
):
    samples = in_episodes(share)
    samples.filtered_logs = [
        SimpleNamespace(
            signals=SimpleNamespace(subject=SimpleNamespace(stall_torque=np.array([line])))
        )
    ]
    judge = SimpleNamespace(base=SimpleNamespace(samples=samples), thresholds=load_thresholds())
    judge.shown = lambda model, place: np.array([0.5, 9.0] if episode else [9.0, 0.5])
    model = SimpleNamespace(
        causes=(of_battery(effect, unseen),), values=lambda place: np.array([1.0, 0.5])
    )
    assert unshown(judge, model) is seldom
    judge.thresholds = replace(
        judge.thresholds, seldom=0.0
    )  # of reference logs: what they show is no cause
    assert not unshown(judge, model)
    model.values = lambda place: np.array([1.0, 4.0])
    assert unshown(judge, model) is (unseen and effect == "voltage_sag"), (
        "a battery that nobody measured takes no more than all torque"
    )


@pytest.mark.parametrize(
    ("gain", "over", "left", "floating", "doubtful", "unsettling", "told", "effect", "worth"),
    [
        (6.5, 6.5, 0.9, False, False, False, False, "backlash", True),
        (5.5, 6.5, 0.9, False, False, False, False, "backlash", False),
        (20.0, 5.5, 0.9, False, False, False, False, "backlash", False),
        (6.5, 6.5, 0.9, True, False, False, False, "payload", False),
        (8.5, 8.5, 0.9, True, False, False, False, "backlash", True),
        (6.5, 6.5, 1.2, False, False, False, False, "backlash", False),
        (6.5, 6.5, 0.9, False, True, False, False, "backlash", False),
        (8.5, 8.5, 0.9, False, True, False, False, "backlash", True),
        (8.5, 8.5, 1.2, False, False, False, False, "backlash", True),
        (3.5, 3.5, 0.9, False, False, True, False, "backlash", True),
        (2.5, 3.5, 0.9, False, False, True, False, "backlash", False),
        (6.5, 6.5, 0.9, True, False, False, True, "payload", True),
        (6.5, 6.5, 0.9, True, False, False, True, "backlash", False),
        (6.5, 6.5, 1.2, True, False, False, True, "payload", False),
    ],
)
def test_evidence_counts_over_the_floor_and_a_doubtful_cause_needs_more(
    gain, over, left, floating, doubtful, unsettling, told, effect, worth
):
    subject = SimpleNamespace(floating=floating)
    samples = SimpleNamespace(
        filtered_logs=[SimpleNamespace(signals=SimpleNamespace(subject=subject))]
    )
    judge = SimpleNamespace(
        base=SimpleNamespace(samples=samples, prior=SimpleNamespace(told=told)),
        thresholds=load_thresholds(),
        holds={},
    )
    judge.gap, judge.excess_rows = lambda square, rows: square, lambda model: np.ones(2, bool)
    judge.closed, judge.shown = (
        lambda held, rows, before: 1.0,
        lambda model, place: np.array([9.0, 0.0]),
    )
    judge.nothing = SimpleNamespace(gain=0.0, over=0.0, causes=())
    causes = (
        SimpleNamespace(
            effect=effect, location="knee", unsettling=unsettling, unseen=False, doubtful=doubtful
        ),
    )
    assert (
        worth_naming(
            judge,
            SimpleNamespace(
                gain=gain, over=over, causes=causes, held=SimpleNamespace(bare=2.0, square=left)
            ),
        )
        is worth
    )


@pytest.mark.parametrize(
    ("effect", "gain", "over", "band", "already", "shows"),
    [
        ("joint_spring", 31.0, 16.0, 1.1, 0, True),
        ("joint_spring", 31.0, 16.0, 0.9, 0, False),
        ("joint_spring", 29.0, 16.0, 1.1, 0, False),
        ("joint_spring", 31.0, 14.0, 1.1, 0, False),
        ("joint_spring", 31.0, 16.0, 1.1, 1, True),
        ("joint_spring", 31.0, 16.0, 1.1, 2, False),
        ("joint_spring", 61.0, 31.0, 1.1, 2, True),
        ("torque_saturation", 31.0, 16.0, 1.1, 0, False),
    ],
)
def test_what_is_slow_shows_in_its_band_where_a_row_is_noisy(
    effect, gain, over, band, already, shows
):
    before = SimpleNamespace(gain=5.0, over=3.0, causes=(None,) * already)
    model = SimpleNamespace(
        gain=5.0 + gain, over=3.0 + over, causes=(*before.causes, SimpleNamespace(effect=effect))
    )
    samples = SimpleNamespace(episodic=np.array([False, False, True]))
    judge = SimpleNamespace(base=SimpleNamespace(samples=samples), thresholds=load_thresholds())
    judge.shown_in_bands = lambda m, place: np.array([0.1, band**2, 9.0])
    assert shows_in_a_band(judge, model, before) is shows


def rows_of(shown, bare, left, nothing, effect="coulomb_friction"):
    """A judge and a model of one cause, by what there is in two rows and their episodes."""
    samples = SimpleNamespace(
        rows=(
            SimpleNamespace(name="hip", residual_name="motion"),
            SimpleNamespace(name="knee", residual_name="motion"),
        )
    )
    held = {
        k: np.array(v)
        for k, v in (("bare", bare), ("left", left), ("nothing", nothing), ("shown", shown))
    }
    judge = SimpleNamespace(
        base=SimpleNamespace(samples=samples),
        thresholds=load_thresholds(),
        rows=lambda kind: held[kind],
        holds={},
    )
    judge.shown = lambda model, place: held["shown"]
    judge.own = lambda model, place: np.array([False, True, False, False])
    judge.nothing = SimpleNamespace(held=SimpleNamespace(square="nothing"))
    cause = SimpleNamespace(effect=effect)
    return judge, SimpleNamespace(causes=(cause,), held=SimpleNamespace(bare="bare", square="left"))


def test_a_small_cause_stands_out_if_it_is_most_of_what_there_is():
    shown = (0.0, 0.9, 0.0, 0.0)
    assert stands_out(*rows_of(shown, (0.5, 1.0, 0, 0), (0.5, 0.2, 0, 0), (0.5, 0.4, 0, 0)))
    assert not stands_out(*rows_of(shown, (0.5, 1.0, 0, 0), (0.5, 0.6, 0, 0), (0.5, 0.9, 0, 0)))
    assert not stands_out(*rows_of(shown, (0.5, 1.0, 0, 0), (0.5, 0.2, 0, 0), (0.5, 0.2, 0, 0))), (
        "calibration errors leave as little"
    )
    assert not stands_out(
        *rows_of((0.0, 0.1, 0.0, 0.0), (0.5, 1.0, 0, 0), (0.5, 0.2, 0, 0), (0.5, 0.4, 0, 0))
    ), "hardly to be seen"
    limited = rows_of(
        shown, (0.5, 1.0, 0, 0), (0.5, 0.2, 0, 0), (0.5, 0.4, 0, 0), effect="torque_saturation"
    )
    assert not stands_out(*limited), "healthy drives reach limits"


def test_a_joint_that_sticks_excuses_its_own_gap_alone():
    rows = np.array([True, True, False, False])
    for left, excused in (((9.0, 1.0, 0, 0), True), ((9.0, 9.0, 0, 0), False)):
        judge, model = rows_of((1.0, 1.0, 0, 0), (9.0, 9.0, 0, 0), left, (9.0, 9.0, 0, 0))
        judge.holds, judge.held = {"hip": 2.0}, lambda model, joint: 0.9
        assert sticks_alone(judge, model, rows) is excused
        judge.held = lambda model, joint: 0.1
        assert not sticks_alone(judge, model, rows)


def test_what_is_much_likelier_is_named_and_not_what_imitates_it(judged):
    judge, found = judged
    right, imitation = found.slots[0][0], found.slots[0][1]
    assert rank(right) > rank(imitation) + judge.thresholds.alike
    assert likelier(judge, found.slots[0], imitation).names == right.names
    assert likelier(judge, found.slots[0][1:], imitation).names == imitation.names
    unseen = replace(right, causes=(replace(right.causes[0], effect="torque_saturation"),))
    assert likelier(judge, [unseen, imitation], imitation).names == imitation.names


def test_a_cause_on_a_walk_must_be_nearly_as_large_as_the_floor():
    rules = load_thresholds()
    for floating, least in ((False, rules.visible), (True, rules.visible_afoot)):
        samples = SimpleNamespace(
            filtered_logs=[
                SimpleNamespace(signals=SimpleNamespace(subject=SimpleNamespace(floating=floating)))
            ]
        )
        judge = SimpleNamespace(base=SimpleNamespace(samples=samples), thresholds=rules)
        for size in (0.9 * least, 1.1 * least):
            judge.shown = lambda model, place, size=size: np.array([0.1, size]) ** 2
            assert _visible(judge, SimpleNamespace(causes=(None,))) is (size > least)


def test_what_two_causes_tell_adds_up_and_what_an_imitation_tells_does_not(two_wrong):
    samples, null = two_wrong.base.samples, np.zeros(1)
    knee, hip, like_hip = (
        linearise(samples, EFFECTS[effect], place, null)
        for effect, place in (
            ("viscous_friction", "knee"),
            ("coulomb_friction", "hip"),
            ("load_dependent_friction", "hip"),
        )
    )
    least = two_wrong.thresholds.evident_doubtful
    alone, both = two_wrong.model([knee]), two_wrong.model([knee, hip])
    assert min(alone.gain, two_wrong.model([hip]).gain, two_wrong.model([like_hip]).gain) > least
    assert apart(two_wrong, both, alone)
    assert not apart(two_wrong, two_wrong.model([hip, like_hip]), two_wrong.model([hip]))
    weak = replace(both, gain=alone.gain + 0.9 * least)
    assert not apart(two_wrong, weak, alone), "as much as a first cause needs"


class Faint(Judge):
    """Sees last causes at a size over the floor in all rows and at another in one band, as much
    alone as beside others, and nothing left.
    """

    def sees(self, size, band, alone):
        self.__dict__.update(size=size, band=band, alone=alone, holds={})
        return self

    def shown(self, model, place):
        found = super().shown(model, place)
        return found / found.max() * self.size**2

    def shown_in_bands(self, model, place):
        found = super().shown_in_bands(model, place)
        return found / found.max() * self.band**2

    def rows(self, square, blocks=None):
        return np.full_like(super().rows(square, blocks), 0.5)

    def model(self, causes):
        return replace(super().model(causes), gain=self.alone, below=0.0)


@pytest.mark.parametrize(
    ("size", "band", "gain", "alone", "worth"),
    [
        (0.8, 1.1, 20.0, 19.0, True),
        (0.8, 0.9, 20.0, 19.0, False),
        (0.8, 1.1, 14.0, 14.0, False),
        (0.8, 1.1, 20.0, 12.0, False),
        (1.1, 0.9, 16.0, 16.0, True),
        (1.5, 0.9, 9.0, 9.0, True),
        (1.5, 0.9, 7.5, 7.5, False),
        (1.5, 0.9, 8.5, 2.0, False),
        (1.1, 0.9, 9.0, 9.0, True),
        (0.95, 0.9, 9.0, 9.0, False),
    ],
)
def test_a_further_cause_with_evidence_of_its_own_needs_less(
    two_wrong, size, band, gain, alone, worth
):
    samples = two_wrong.base.samples
    knee, hip = (
        linearise(samples, EFFECTS[e], at, np.zeros(1))
        for e, at in (("viscous_friction", "knee"), ("coulomb_friction", "hip"))
    )
    before = two_wrong.model([knee])
    both = replace(two_wrong.model([knee, hip]), gain=before.gain + gain, below=before.below)
    assert (
        worth_adding(
            Faint(two_wrong.base, two_wrong.thresholds, 1).sees(size, band, alone), both, before
        )
        is worth
    )
