import json

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.validation.blind.score import compared, score
from hyperleg_design.validation.blind.trial import sealed
from hyperleg_design.writing import write_bytes, write_json


def truth(kind, *wrongs, case="000"):
    return {
        "case": case,
        "kind": kind,
        "plant": "rig",
        "robot": "arm",
        "references": True,
        "torque": "motor_current",
        "wrongs": [
            {
                "effect": e,
                "listed": kind != "outside",
                "location": p,
                "also": [p],
                "multiple": m,
                "parameters": values,
            }
            for e, p, m, values in wrongs
        ],
    }


def said(verdict, *causes, rivals=(), equivalent=()):
    def form(cause):
        effect, location, probability, values = cause
        parameters = {
            k: {"value": v, "low": lo, "high": hi, "unit": ""} for k, (v, lo, hi) in values.items()
        }
        return {
            "effect": effect,
            "location": location,
            "probability": probability,
            "closed": 0.9,
            "parameters": parameters,
        }

    return {
        "verdict": verdict,
        "causes": [form(c) for c in causes],
        "rivals": [form(c) for c in rivals],
        "equivalent": list(equivalent),
    }


PAYLOAD = ("payload", "flange", 3.0, {"mass": 1.0})
RIGHT = ("payload", "flange", 0.95, {"mass": (1.05, 0.9, 1.2)})
WRONG = ("link_mass", "flange", 0.6, {})


def test_a_right_answer_reaches_everything():
    found = compared(
        [
            truth("single", PAYLOAD),
            truth("null"),
            truth("outside", ("hysteresis", "elbow", 3.0, {})),
        ],
        [
            said("explained", RIGHT),
            said("none"),
            said("unknown"),
        ],
        [1.0, 2.0, 3.0],
    )
    assert found.misses == ()
    for measure, value in (
        ("right effect, single cause at >= 2 x floor, first", 1.0),
        ("... among the first two", 1.0),
        ("right location, where the effect is right", 1.0),
        ("false alarm when nothing is wrong", 0.0),
        ("unknown on effects outside the catalogue, at >= 2 x floor", 1.0),
        ("seconds a diagnosis, median", 2.0),
        ("95 % parameter intervals that hold the truth", 1.0),
        ("excess gap closed on held-out logs, named single cause, median", 0.9),
    ):
        assert found.row(measure).value == pytest.approx(value), measure
    assert found.row("both found when two act, each at >= 2 x floor").value is None
    assert "payload" in found.markdown()


def test_second_place_and_equivalents_are_told_apart_from_first():
    second = compared([truth("single", PAYLOAD)], [said("explained", WRONG, rivals=[RIGHT])], [1.0])
    assert second.row("right effect, single cause at >= 2 x floor, first").value == 0
    assert second.row("... among the first two").value == 1
    assert [m.why for m in second.misses] == ["wrong effect"]
    group = [
        [{"effect": "link_mass", "location": "flange"}, {"effect": "payload", "location": "flange"}]
    ]
    for equivalent in (
        group,
        [[["link_mass", "flange"], ["payload", "flange"]]],
        [["link_mass at flange", "payload at flange"]],
    ):
        lenient = compared(
            [truth("single", PAYLOAD)], [said("ambiguous", WRONG, equivalent=equivalent)], [1.0]
        )
        assert lenient.row("right effect, single cause at >= 2 x floor, first").value == 0
        assert lenient.row("... or in one set with the first").value == 1
        assert lenient.misses == ()


def test_what_logs_do_not_show_is_counted_apart():
    """Of a load of 1 kg at twice the floor: where the logs would have shown half of it, three times
    it, none, and where nothing is said.
    """
    smallest = {"effect": "payload", "location": "flange", "parameter": "mass", "unit": "kg"}
    other = {**smallest, "effect": "link_mass"}
    told = [
        [{**smallest, "change": 0.5}],
        [{**smallest, "change": 3.0}],
        [{**other, "change": 0.1}],
        [],
    ]
    answers = [said("explained", RIGHT), said("none"), said("none"), said("none")]
    found = compared(
        [truth("single", PAYLOAD)] * 4,
        [{**a, "sensitivity": t} for a, t in zip(answers, told, strict=True)],
        [None] * 4,
    )
    large, small = (
        found.row(m)
        for m in (
            "... first, of those no smaller than what the diagnosis says its logs show",
            "... first, of those smaller than that",
        )
    )
    assert (large.value, large.cases, small.value, small.cases) == (1.0, 1, 0.0, 2)
    assert found.row("right effect, single cause at >= 2 x floor, first").cases == 4


def test_changes_of_several_parameters_add_up():
    gain = ("controller_gain", "flange", 3.0, {"stiffness_scale": 1.09, "damping_scale": 0.91})
    told = [
        {
            "effect": "controller_gain",
            "location": "flange",
            "parameter": p,
            "change": 0.1,
            "unit": "",
        }
        for p in ("stiffness_scale", "damping_scale")
    ]
    row = "... first, of those no smaller than what the diagnosis says its logs show"
    assert (
        compared([truth("single", gain)], [{**said("none"), "sensitivity": told}], [None])
        .row(row)
        .cases
        == 1
    )
    assert (
        compared([truth("single", gain)], [{**said("none"), "sensitivity": told[:1]}], [None])
        .row(row)
        .cases
        == 0
    )


def test_misses_of_every_kind():
    two = truth("compound", PAYLOAD, ("command_delay", "robot", 3.0, {}))
    cases = [
        (truth("single", PAYLOAD), said("none"), "no cause named"),
        (truth("single", PAYLOAD), said("explained", ("payload", "elbow", 0.9, {})), "wrong place"),
        (truth("null"), said("explained", RIGHT), "false alarm"),
        (
            truth("outside", ("hysteresis", "a", 3.0, {})),
            said("explained", RIGHT),
            "not called unknown",
        ),
        (two, said("explained", RIGHT), "one of two found"),
        (two, said("unknown"), "neither found"),
        (two, {"verdict": "error", "message": "x"}, "error"),
    ]
    found = compared([t for t, *_ in cases], [d for _, d, _ in cases], [None] * len(cases))
    assert [m.why for m in found.misses] == [why for *_, why in cases]
    assert found.row("both found when two act, each at >= 2 x floor").value == 0
    assert found.row("... at least one of them").value == pytest.approx(1 / 3)


def test_below_twice_the_floor_a_miss_does_not_count_against_the_target():
    small = ("payload", "flange", 1.5, {"mass": 1.0})
    found = compared([truth("single", small)], [said("none")], [1.0])
    assert found.row("right effect, single cause at >= 2 x floor, first").cases == 0
    assert found.row("right effect, single cause below 2 x floor, first").value == 0


@pytest.fixture
def trial(tmp_path):
    import hashlib

    asked = {"cases": 2, "seed": 5, "plants": ["rig"], "duration": [2.0, 3.0]}
    key = sealed([truth("single", PAYLOAD, case="000"), truth("null", case="001")], asked)
    write_bytes(tmp_path / "key.zip", key)
    write_json(tmp_path / "seal.json", {"sha256": hashlib.sha256(key).hexdigest(), **asked})
    for name, diagnosis in (("000", said("explained", RIGHT)), ("001", said("none"))):
        write_json(tmp_path / "diagnoses" / name / "diagnosis.json", diagnosis)
        write_json(tmp_path / "diagnoses" / name / "seconds.json", {"seconds": 1.5})
    return tmp_path


def test_a_key_is_opened_once(trial):
    first = score(trial)
    assert not first.reread
    assert json.loads((trial / "scored.json").read_text())["sha256"] == first.sha256
    with pytest.raises(InputError, match="scored already"):
        score(trial)
    again = score(trial, reread=True)
    assert again.reread
    assert again.rows == first.rows


def test_a_key_that_was_changed_is_refused(trial):
    (trial / "key.zip").write_bytes((trial / "key.zip").read_bytes() + b" ")
    with pytest.raises(InputError, match="not the key that was sealed"):
        score(trial)
    assert not (trial / "scored.json").exists()


def test_missing_diagnoses_stop_the_scoring_before_the_key_is_opened(trial):
    (trial / "diagnoses" / "001" / "seconds.json").unlink()
    with pytest.raises(InputError, match="lack a diagnosis"):
        score(trial)
    assert not (trial / "scored.json").exists()
    assert score(trial, partial=True).diagnosed == 1


def test_no_trial_there(tmp_path):
    with pytest.raises(InputError, match="no finished trial"):
        score(tmp_path)
