from dataclasses import replace
from types import SimpleNamespace

import diagnosed
import numpy as np
import robots
from diagnosed import in_episodes

from hyperleg_design.gap.inference import decide
from hyperleg_design.gap.inference.decide import (
    BELTS,
    DECISIVE,
    _as_healthy,
    _chosen,
    _fails,
    _finalists,
    _from,
    _leaves_nothing,
    _paired,
    _taken,
    _told_apart,
    _verdict,
)
from hyperleg_design.gap.inference.equivalence import alike
from hyperleg_design.gap.inference.judge import Judge, rank
from hyperleg_design.gap.inference.thresholds import load_thresholds


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
    for several, verdict in (
        (strict, "unknown"),
        (replace(strict, far_required=0.5 * closed), "explained"),
    ):
        assert _verdict(replace(judge, thresholds=several), found.model, found.rows, ()) == verdict


def test_several_drives_at_limits_that_nobody_declared_have_something_else_in_common(judged):
    judge, found = judged
    limit = replace(found.model.causes[0], effect="torque_saturation")
    for causes, verdict in (
        ((limit,), "explained"),
        ((limit, replace(limit, location="hip")), "unknown"),
    ):
        assert _verdict(judge, replace(found.model, causes=causes), found.rows, ()) == verdict


def test_a_belt_may_leave_more_of_a_large_gap_than_other_causes(judged):
    judge, found = judged
    closed = judge.closed(found.model.held, found.rows, found.model.held)
    strict = replace(judge.thresholds, far=0.0, far_required=1.01 * closed, required=0.9 * closed)
    belt = replace(found.model.causes[0], effect=BELTS[1])
    for causes, verdict in ((found.model.causes, "unknown"), ((belt,), "explained")):
        assert (
            _verdict(
                replace(judge, thresholds=strict),
                replace(found.model, causes=causes),
                found.rows,
                (),
            )
            == verdict
        )


def test_balances_that_tell_play_from_a_spring_by_far_are_believed(judged):
    model = judged[1].model
    play, spring, elsewhere = (
        replace(model, causes=(replace(model.causes[0], effect=effect, location=place),))
        for effect, place in ((BELTS[0], "knee"), (BELTS[1], "knee"), (BELTS[1], "hip"))
    )
    heard = SimpleNamespace(location="knee")
    assert _told_apart(spring, [spring, elsewhere], heard)
    assert not _told_apart(spring, [spring, replace(play, gain=play.gain - DECISIVE / 2)], heard)
    assert _told_apart(spring, [spring, replace(play, gain=play.gain - 2 * DECISIVE)], heard)
    assert not _told_apart(elsewhere, [elsewhere, spring], heard)
    assert not _told_apart(model, [model], heard)


def test_a_belt_gives_in_one_way(judged):
    one = judged[1].model.causes[0]
    assert _taken([one]) == {one.name}
    assert _taken([one, replace(one, effect=BELTS[0], location="hip")]) == {
        one.name,
        (BELTS[0], "hip"),
        (BELTS[1], "hip"),
    }


def test_a_pair_that_none_of_its_rivals_leads_to_is_found_among_the_finalists(two_wrong):
    true = {("viscous_friction", "knee"), ("coulomb_friction", "hip")}
    wanted = [
        *true,
        ("coulomb_friction", "knee"),
        ("stribeck_friction", "hip"),
        ("viscous_friction", "hip"),
    ]
    singles, _ = _finalists(two_wrong, wanted, ())
    alone = {m.names[0]: m for m in singles}
    wrong = two_wrong.model(
        [alone["coulomb_friction", "knee"].causes[0], alone["viscous_friction", "hip"].causes[0]]
    )
    found, slots = _paired(two_wrong, wanted, singles, wrong, [(wrong,), (wrong,)])
    assert set(found.names) == true
    assert rank(found) > rank(wrong)
    assert all(found.names in [m.names for m in slot] for slot in slots)
    assert _paired(two_wrong, wanted, singles, found, slots) == (found, slots), "what is best stays"
    assert _from([wrong, found], found) == (found,)


def test_an_error_of_a_links_mass_is_judged_beside_a_load_on_it_however_few_are(
    robot_files, monkeypatch
):
    log = robots.geared_run("joint", ("hip", "knee"), load=0.5)
    judge = Judge(diagnosed.prepared(robot_files["geared"], log).base, load_thresholds(), 1)
    wanted = [
        ("link_mass", "shank"),
        ("payload", "shank"),
        ("link_mass", "thigh"),
        ("viscous_friction", "knee"),
    ]
    monkeypatch.setattr(decide, "FINALISTS", 1)
    models, _ = _finalists(judge, wanted, ())
    assert {m.names[0] for m in models} == {("link_mass", "shank"), ("payload", "shank")}
    assert [rank(m) for m in models] == sorted((rank(m) for m in models), reverse=True)
    assert len(_finalists(judge, wanted[:1], ())[0]) == 1, "what nobody asked for is not tried"


def supplied(voltage, nominal):
    subject = SimpleNamespace(voltage=nominal)
    return SimpleNamespace(
        filtered_logs=[
            SimpleNamespace(signals=SimpleNamespace(voltage=v, subject=subject)) for v in voltage
        ]
    )


def test_a_battery_as_full_as_in_reference_logs_is_no_cause():
    rng = np.random.default_rng(0)
    full, weak = 48 + 0.05 * rng.standard_normal((2, 500)), 40 + 0.05 * rng.standard_normal(500)
    assert _as_healthy(supplied(full, 48.0))
    assert not _as_healthy(supplied([*full, weak], 48.0))
    assert not _as_healthy(supplied(full, float("nan")))
    assert not _as_healthy(supplied([full[0], None], 48.0))


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


def test_commands_that_get_lost_leave_something_in_rows_or_their_episodes(judged):
    judge, found = judged
    assert _leaves_nothing(judge, found.model)
    assert not _leaves_nothing(judge, replace(found.model, causes=())), (
        "what nobody explains may be anything"
    )
    assert not _leaves_nothing(
        replace(judge, thresholds=replace(judge.thresholds, largest_excess=0.1)), found.model
    )


def test_the_first_cause_is_not_what_imitates_a_much_likelier_one(two_wrong, monkeypatch):
    wanted = [("viscous_friction", "knee"), ("coulomb_friction", "knee")]
    singles, _ = _finalists(two_wrong, wanted, ())
    assert [m.names[0] for m in singles] == wanted
    assert rank(singles[0]) > rank(singles[1]) + two_wrong.thresholds.alike
    monkeypatch.setattr(
        decide, "worth_naming", lambda judge, model: model.names == singles[1].names
    )
    monkeypatch.setattr(decide, "worth_adding", lambda *_: False)
    assert _chosen(two_wrong, wanted, singles)[0].names == singles[0].names
