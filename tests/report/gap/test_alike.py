"""Causes of one effect as one line, against the causes themselves."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.report.gap.alike import (
    FEWEST,
    places,
    span_text,
    spans,
    telling,
    together,
)

EFFECTS = ("coulomb_friction", "viscous_friction", "payload")
CAUSES = st.lists(st.tuples(st.sampled_from(EFFECTS), st.sampled_from(["Nm", "N"])), max_size=12)


def cause(effect: str, number: int, unit: str = "Nm") -> dict:
    value = {"value": number, "low": number - 0.5, "high": number + 0.5, "unit": unit}
    return {"effect": effect, "location": f"place_{number}", "parameters": {"torque": value}}


@given(CAUSES)
def test_every_cause_is_in_one_group_of_one_effect_in_one_unit(kinds) -> None:
    causes = [cause(effect, number, unit) for number, (effect, unit) in enumerate(kinds)]
    groups = together(causes)
    listed = [entry["location"] for group in groups for entry in group]
    assert sorted(listed) == sorted(entry["location"] for entry in causes)
    for group in groups:
        assert len({(e["effect"], e["parameters"]["torque"]["unit"]) for e in group}) == 1
        assert len(group) == 1 or len(group) >= FEWEST
    firsts = [int(group[0]["location"].removeprefix("place_")) for group in groups]
    assert firsts == sorted(firsts)


def test_few_places_are_named_and_many_are_counted() -> None:
    assert places([cause("payload", i) for i in range(4)]) == "place_0, place_1, place_2, place_3"
    assert places([cause("payload", i) for i in range(5)]) == "5 links"
    assert places([cause("ground_friction", i) for i in range(5)]) == "5 feet"


def test_a_range_reaches_from_the_least_to_the_largest() -> None:
    (span,) = spans([cause("coulomb_friction", number) for number in (3, 1, 2)])
    assert (span.least, span.most, span.low, span.high) == (1.0, 3.0, 0.5, 3.5)
    assert (span.name, span.unit, span.words) == ("torque", "Nm", "")
    assert span_text(span.least, span.most) == "1 to 3"
    assert span_text(0.80001, 0.80002) == "0.8"


def test_a_wave_is_known_by_its_amplitude() -> None:
    sizes = {
        name: {"value": 0.1, "low": 0.09, "high": 0.11, "unit": "Nm"}
        for name in ("cosine", "sine", "order", "amplitude")
    }
    wave = {"effect": "cogging", "location": "knee", "parameters": sizes}
    assert telling([wave]) == "amplitude"
    spring = dict.fromkeys(("stiffness", "preload"), sizes["sine"])
    spring["stiffness"] = spring["stiffness"] | {"low": -0.01}
    pull = {"effect": "joint_spring", "location": "knee", "parameters": spring}
    assert telling([pull]) == "preload"
