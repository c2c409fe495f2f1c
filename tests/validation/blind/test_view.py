import pytest

from hyperleg_design.validation.blind.view import View, said_of


def wrong(effect, place, multiple=3.0, **parameters):
    return {
        "effect": effect,
        "listed": True,
        "location": place,
        "also": [place],
        "multiple": multiple,
        "parameters": parameters,
    }


def truth(*wrongs, kind="single"):
    return {"case": "000", "kind": kind, "plant": "rig", "robot": "arm", "wrongs": list(wrongs)}


def cause(effect, place, probability=0.9):
    return {
        "effect": effect,
        "location": place,
        "probability": probability,
        "closed": 0.8,
        "parameters": {},
    }


LOAD = wrong("payload", "flange", mass=1.0)


@pytest.mark.parametrize(
    ("verdict", "causes", "why"),
    [
        ("explained", [cause("payload", "flange")], ""),
        ("explained", [cause("payload", "elbow")], "wrong place"),
        ("explained", [cause("link_mass", "flange")], "wrong effect"),
        ("none", [], "no cause named"),
        ("unknown", [], "no cause named"),
        ("error", [], "error"),
    ],
)
def test_a_miss_says_why(verdict, causes, why):
    view = View(
        truth(LOAD),
        {"verdict": verdict, "causes": causes, "rivals": [cause("payload", "flange", 0.1)]},
    )
    found = view.miss()
    assert (found.why if found else "") == why
    assert view.top_two() is (verdict == "explained")


def test_a_rival_of_a_robot_without_a_gap_is_not_named():
    assert not View(
        truth(LOAD), {"verdict": "none", "causes": [], "rivals": [cause("payload", "flange")]}
    ).first(lenient=True)


def test_limits_and_batteries_have_no_smallest_size():
    limit = {
        "effect": "torque_saturation",
        "location": "elbow",
        "parameter": "inverse_limit",
        "change": 0.1,
        "unit": "1/Nm",
    }
    assert (
        View(
            truth(wrong("torque_saturation", "elbow", limit=3.0)),
            {"verdict": "none", "sensitivity": [limit]},
        ).shown
        is None
    )


def test_what_no_possible_size_would_show_is_smaller_than_what_shows():
    other = {
        "effect": "payload",
        "location": "elbow",
        "parameter": "mass",
        "change": 0.1,
        "unit": "kg",
    }
    assert View(truth(LOAD), {"verdict": "none", "sensitivity": [other]}).shown is False
    assert (
        View(
            truth(LOAD), {"verdict": "none", "sensitivity": [{**other, "location": "flange"}]}
        ).shown
        is True
    )


def test_what_was_said_names_the_rival_of_a_set():
    told = {
        "verdict": "ambiguous",
        "causes": [cause("payload", "flange")],
        "rivals": [cause("link_mass", "flange")],
    }
    assert said_of(told) == "payload at flange, or link_mass at flange"
    assert said_of({**told, "verdict": "none"}) == ""
