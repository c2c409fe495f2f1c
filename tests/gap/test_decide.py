from dataclasses import replace
from types import SimpleNamespace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.decide import _as_healthy, _fails, _large, _likelier, _seldom, _stands_out, _sticks_alone, _verdict, decide
from hyperleg_design.gap.equivalence import alike
from hyperleg_design.gap.judge import Judge, rank
from hyperleg_design.gap.screen import places
from hyperleg_design.gap.thresholds import load_thresholds


@pytest.fixture(scope="module")
def judged(robot_files):
    ready = diagnosed.prepared(robot_files["coupled"], *(diagnosed.run("viscous", s, session="a") for s in (0, 1)))
    subject = ready.base.samples.sieves[0].signals.subject
    friction = ("viscous_friction", "coulomb_friction", "stribeck_friction", "torque_constant")
    return decide(ready.base, load_thresholds(), places(subject, friction))


def test_the_gap_is_what_the_cause_leaves_out(judged):
    judge, found = judged
    assert found.verdict == "explained"
    assert found.model.names == (("viscous_friction", "knee"),)
    rows = [judge.base.samples.rows[r].name for r in np.flatnonzero(found.rows)]
    assert rows == ["knee"]
    assert judge.closed(found.model.held, found.rows, found.model.held) > 0.95
    assert judge.closed(judge.nothing.held, found.rows, found.model.held) < 0.5


def test_each_slot_has_the_chosen_first(judged):
    judge, found = judged
    assert found.slots[0][0].names == found.model.names
    gains = [rank(m) for m in found.slots[0]]
    assert gains == sorted(gains, reverse=True)
    assert alike(judge, found.slots[0], found.model, found.rows) == []


def test_nothing_is_left_by_nothing(judged):
    judge, _ = judged
    assert isinstance(judge, Judge)
    assert judge.nothing.gain == 0
    assert np.allclose(judge.nothing.held.square, judge.nothing.held.bare)


def test_causes_that_leave_far_more_than_the_floor_must_close_most_of_it(judged):
    judge, found = judged
    rules = judge.thresholds
    closed = judge.closed(found.model.held, found.rows, found.model.held)
    strict = replace(rules, far=0.0, far_required=1.01 * closed)
    for several, verdict in ((strict, "unknown"), (replace(strict, far_required=0.5 * closed), "explained")):
        assert _verdict(replace(judge, thresholds=several), found.model, found.rows, ()) == verdict


def test_several_drives_at_limits_that_nobody_declared_have_something_else_in_common(judged):
    judge, found = judged
    limit = replace(found.model.causes[0], effect="torque_saturation")
    for causes, verdict in (((limit,), "explained"), ((limit, replace(limit, location="hip")), "unknown")):
        assert _verdict(judge, replace(found.model, causes=causes), found.rows, ()) == verdict


def supplied(voltage, nominal):
    subject = SimpleNamespace(voltage=nominal)
    return SimpleNamespace(sieves=[SimpleNamespace(signals=SimpleNamespace(voltage=v, subject=subject)) for v in voltage])


def test_a_battery_as_full_as_in_reference_logs_is_no_cause():
    rng = np.random.default_rng(0)
    full, weak = 48 + 0.05 * rng.standard_normal((2, 500)), 40 + 0.05 * rng.standard_normal(500)
    assert _as_healthy(supplied(full, 48.0))
    assert not _as_healthy(supplied([*full, weak], 48.0))
    assert not _as_healthy(supplied(full, float("nan")))
    assert not _as_healthy(supplied([full[0], None], 48.0))


def in_episodes(share, *balances):
    """Rows of 1000 samples each in two groups, the second their episodes."""
    balances = balances or ("drive",)
    group = np.tile((np.arange(1000) < 1000 * share).astype(int), len(balances))
    rows = tuple(SimpleNamespace(balance=balance) for balance in balances)
    row = np.repeat(np.arange(len(balances)), 1000)
    return SimpleNamespace(rows=rows, row=row, group=group, episodic=np.array([False, True]), share=np.full(len(row), 0.5))


def test_a_drive_that_often_fails_its_commands_is_a_gap():
    rules = load_thresholds()
    assert _fails(in_episodes(1.2 * rules.failing), rules)
    assert not _fails(in_episodes(0.8 * rules.failing), rules)
    assert not _fails(in_episodes(1.2 * rules.failing, "motion"), rules)
    assert _fails(in_episodes(1.2 * rules.failing, "motion", "motion"), rules)
    assert not _fails(in_episodes(0.8 * rules.failing, "motion", "motion"), rules)
    told = in_episodes(1.2 * rules.failing, "motion", "motion", "drive")
    told.group[told.row == 2] = 0
    assert not _fails(told, rules), "drives that were measured do what they are told"


def of_battery(effect, unseen):
    """A cause of two sizes, of which the second is 4 at most."""
    return SimpleNamespace(effect=effect, unseen=unseen, high=np.array([20.0, 4.0]), shape=np.zeros(2, bool))


@pytest.mark.parametrize(("share", "effect", "line", "episode", "unseen", "seldom"), [
    (0.01, "voltage_sag", np.inf, True, False, True),
    (0.03, "voltage_sag", np.inf, True, False, False),
    (0.03, "voltage_sag", np.inf, True, True, True),
    (0.03, "voltage_sag", 3.0, True, True, False),
    (0.01, "voltage_sag", 3.0, True, False, False),
    (0.01, "voltage_sag", np.inf, False, False, False),
    (0.01, "torque_saturation", np.inf, True, False, False),
])  # fmt: skip
def test_a_weak_battery_shows_more_often_than_limits_of_healthy_drives_or_by_its_voltage(share, effect, line, episode, unseen, seldom):
    samples = in_episodes(share)
    samples.sieves = [SimpleNamespace(signals=SimpleNamespace(subject=SimpleNamespace(stall_torque=np.array([line]))))]
    judge = SimpleNamespace(base=SimpleNamespace(samples=samples), thresholds=load_thresholds())
    judge.shown = lambda model, place: np.array([0.5, 9.0] if episode else [9.0, 0.5])
    model = SimpleNamespace(causes=(of_battery(effect, unseen),), values=lambda place: np.array([1.0, 0.5]))
    assert _seldom(judge, model) is seldom
    judge.thresholds = replace(judge.thresholds, seldom=0.0)  # of reference logs: what they show is no cause
    assert not _seldom(judge, model)
    model.values = lambda place: np.array([1.0, 4.0])
    assert _seldom(judge, model) is (unseen and effect == "voltage_sag"), "a battery that nobody measured takes no more than all torque"


@pytest.mark.parametrize(("gain", "gap", "left", "floating", "large"), [
    (7.5, 2.0, 1.0, False, True), (6.5, 2.0, 1.0, False, False), (7.5, 1.5, 1.0, False, False), (7.5, 2.0, 1.0, True, False),
    (7.5, 9.0, 4.0, False, False),
])  # fmt: skip
def test_less_evidence_will_do_to_explain_all_of_a_gap_clearly_over_the_floor_of_a_held_base(gain, gap, left, floating, large):
    subject = SimpleNamespace(floating=floating)
    samples = SimpleNamespace(sieves=[SimpleNamespace(signals=SimpleNamespace(subject=subject))])
    judge = SimpleNamespace(base=SimpleNamespace(samples=samples), thresholds=load_thresholds())
    judge.gap, judge.excess_rows = lambda square, rows: np.asarray(square), lambda model: np.ones(2, bool)
    assert _large(judge, SimpleNamespace(gain=gain, held=SimpleNamespace(bare=gap, square=left))) is large


def rows_of(shown, bare, left, nothing, effect="coulomb_friction"):
    """A judge and a model of one cause, by what there is in two rows and their episodes."""
    samples = SimpleNamespace(rows=(SimpleNamespace(name="hip", balance="motion"), SimpleNamespace(name="knee", balance="motion")))
    held = {k: np.array(v) for k, v in (("bare", bare), ("left", left), ("nothing", nothing), ("shown", shown))}
    judge = SimpleNamespace(base=SimpleNamespace(samples=samples), thresholds=load_thresholds(), rows=lambda kind: held[kind], holds={})
    judge.shown = lambda model, place: held["shown"]
    judge.own = lambda model, place: np.array([False, True, False, False])
    judge.nothing = SimpleNamespace(held=SimpleNamespace(square="nothing"))
    cause = SimpleNamespace(effect=effect)
    return judge, SimpleNamespace(causes=(cause,), held=SimpleNamespace(bare="bare", square="left"))


def test_a_small_cause_stands_out_if_it_is_most_of_what_there_is():
    shown = (0.0, 0.9, 0.0, 0.0)
    assert _stands_out(*rows_of(shown, (0.5, 1.0, 0, 0), (0.5, 0.2, 0, 0), (0.5, 0.4, 0, 0)))
    assert not _stands_out(*rows_of(shown, (0.5, 1.0, 0, 0), (0.5, 0.6, 0, 0), (0.5, 0.9, 0, 0)))
    assert not _stands_out(*rows_of(shown, (0.5, 1.0, 0, 0), (0.5, 0.2, 0, 0), (0.5, 0.2, 0, 0))), "calibration errors leave as little"
    assert not _stands_out(*rows_of((0.0, 0.1, 0.0, 0.0), (0.5, 1.0, 0, 0), (0.5, 0.2, 0, 0), (0.5, 0.4, 0, 0))), "hardly to be seen"
    limited = rows_of(shown, (0.5, 1.0, 0, 0), (0.5, 0.2, 0, 0), (0.5, 0.4, 0, 0), effect="torque_saturation")
    assert not _stands_out(*limited), "healthy drives reach limits"


def test_a_joint_that_sticks_excuses_its_own_gap_alone():
    rows = np.array([True, True, False, False])
    for left, excused in (((9.0, 1.0, 0, 0), True), ((9.0, 9.0, 0, 0), False)):
        judge, model = rows_of((1.0, 1.0, 0, 0), (9.0, 9.0, 0, 0), left, (9.0, 9.0, 0, 0))
        judge.holds, judge.held = {"hip": 2.0}, lambda model, joint: 0.9
        assert _sticks_alone(judge, model, rows) is excused
        judge.held = lambda model, joint: 0.1
        assert not _sticks_alone(judge, model, rows)


def test_what_is_much_likelier_is_named_and_not_what_imitates_it(judged):
    judge, found = judged
    right, imitation = found.slots[0][0], found.slots[0][1]
    assert rank(right) > rank(imitation) + judge.thresholds.alike
    assert _likelier(judge, found.slots[0], imitation).names == right.names
    assert _likelier(judge, found.slots[0][1:], imitation).names == imitation.names
    unseen = replace(right, causes=(replace(right.causes[0], effect="torque_saturation"),))
    assert _likelier(judge, [unseen, imitation], imitation).names == imitation.names
