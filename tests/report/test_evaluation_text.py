from __future__ import annotations

from hyperleg_design.report.evaluation_text import OVERHEATS, evaluation_text


def row(measure, mean, *, unit="", missing=0, variant="toe", protocol="walk"):
    """A row as `evaluation_rows` gives it, of ten trials."""
    return {
        "variant": variant,
        "design": "hyperleg",
        "trained": "specialist",
        "protocol": protocol,
        "measure": measure,
        "unit": unit,
        "mean": mean,
        "low": None,
        "high": None,
        "seeds": 1,
        "trials": 10 - missing,
        "missing": missing,
    }


ENDED = [row("arrived", 0.7), row("fell", 0.2), row("lost", 0.0), row("timed_out", 0.1)]


def test_what_no_trial_has_is_named_below_the_table():
    rows = [*ENDED, row("power", 250.5, unit="W", missing=2), row("cadence", None, missing=10)]
    lines = evaluation_text(rows).splitlines()
    assert "None" not in "".join(lines)
    assert "power    W     250.5                 1        2" in lines
    assert "without a value in any trial: cadence" in lines


def test_how_trials_ended_is_counted_and_what_did_not_happen_left_out():
    first = evaluation_text([*ENDED, row("power", 1.0, missing=2)]).splitlines()[0]
    assert first == "toe, specialist, walk: 10 trials, 7 arrived, 2 fell, 1 timed out"
    every = [row("arrived", 1.0), row("fell", 0.0), row("lost", 0.0)]
    assert evaluation_text(every).startswith("toe, specialist, walk: 10 trials, 10 arrived, 0 fell")


def test_measures_that_are_read_first_stand_alone_unless_all_are_asked_for():
    rows = [row("stop_share", 0.1), *ENDED, row("time", 16.0, unit="s")]
    shown = [line.split()[0] for line in evaluation_text(rows).splitlines()[3:]]
    assert shown == ["arrived", "fell", "time", "3"]
    assert evaluation_text(rows).endswith("3 more measures with --all")
    shown = [line.split()[0] for line in evaluation_text(rows, everything=True).splitlines()[3:]]
    assert shown == [r["measure"] for r in rows]


def test_every_protocol_and_variant_has_a_table_of_its_own():
    rows = [
        row("arrived", 1.0),
        row("arrived", 0.5, variant="toe_locked"),
        row("arrived", 0.2, protocol="t_test"),
    ]
    heads = [text.splitlines()[0] for text in evaluation_text(rows).split("\n\n")]
    assert heads == [
        "toe, specialist, walk: 10 trials, 10 arrived",
        "toe_locked, specialist, walk: 10 trials, 5 arrived",
        "toe, specialist, t_test: 10 trials, 2 arrived",
    ]


def test_a_robot_without_variants_is_named():
    text = evaluation_text([row("arrived", 1.0, variant="")])
    assert text.startswith("hyperleg, specialist, walk: 10 trials, 10 arrived")


def test_a_motor_beyond_its_rated_torque_is_told():
    cool, hot = (
        [row("arrived", 1.0), row("continuous_use", use, protocol="walk")] for use in (0.9, 1.328)
    )
    assert OVERHEATS in evaluation_text(hot)
    assert OVERHEATS not in evaluation_text(cool)
