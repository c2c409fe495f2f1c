import pytest

from hyperleg_design.gap.playback.added import Replayed
from hyperleg_design.report.gap.text import diagnosis_text, replayed_text, sensitivity_rows


def diagnosis(**changes):
    cause = {
        "effect": "torque_constant",
        "location": "knee",
        "probability": 0.9,
        "closed": 1.0,
        "parameters": {"scale": {"value": 0.85, "low": 0.84, "high": 0.86, "unit": ""}},
    }
    found = {
        "verdict": "ambiguous",
        "gap": {
            "before": 0.5,
            "after": 0.1,
            "floor": 0.1,
            "unit": "Nm",
            "closed": 1.0,
            "closed_interval": [0.9, 1.0],
        },
        "causes": [cause],
        "rivals": [
            {**cause, "effect": "transmission_ratio", "probability": 0.1, "closed": 0.0},
            {**cause, "effect": "backlash", "probability": 0.001, "parameters": {}},
        ],
        "where": [
            {"location": "knee", "kind": "joint", "regime": "all", "share": 0.6},
            {"location": "knee", "kind": "motor", "regime": "all", "share": 0.3},
            {"location": "hip", "kind": "joint", "regime": "all", "share": 0.1},
        ],
        "separating_experiment": {
            "name": "chirp",
            "do": "sweep the joint",
            "minutes": 2,
            "separates": ["torque_constant at knee", "transmission_ratio at knee"],
        },
    }
    return found | changes


def test_an_answer_states_units_likely_rivals_and_the_experiment_as_a_sentence():
    lines = diagnosis_text(diagnosis()).splitlines()
    assert lines[1] == (
        "residuals [Nm]: 0.5 before, 0.1 with the causes added, noise 0.1; closed on held-out "
        "data: 100 % (90 .. 100)"
    )
    assert [line.split()[1] for line in lines if line.startswith("  rival")] == [
        "transmission_ratio"
    ]
    assert "  where: joint knee 60 %, motor knee 30 %, hip 10 %" in lines
    assert lines[-1] == (
        "  to tell them apart: chirp (2 min): sweep the joint; it separates torque_constant at "
        "knee from transmission_ratio at knee"
    )


@pytest.mark.parametrize(("references", "said"), [([], True), (["healthy"], False)])
def test_a_verdict_without_references_says_what_it_is_about(references, said):
    text = diagnosis_text(diagnosis(provenance={"reference": references}))
    assert ("whether it has changed or not" in text.splitlines()[0]) == said
    nothing = diagnosis(verdict="none", causes=[], provenance={"reference": references})
    assert diagnosis_text(nothing).splitlines()[0] == "verdict: none"


def test_one_effect_at_many_places_is_one_line_with_its_size_at_each():
    (cause,) = diagnosis()["causes"]
    scales = {
        f"m{i}": {"value": 0.8 + i / 1000, "low": 0.7, "high": 0.9, "unit": ""} for i in range(6)
    }
    causes = [
        {**cause, "location": name, "closed": 0.2, "parameters": {"scale": scale}}
        for name, scale in scales.items()
    ]
    lines = diagnosis_text(diagnosis(causes=causes)).splitlines()
    place = lines.index(
        "  cause torque_constant at 6 motors: p 0.90, closes 20 % each; "
        "scale 0.8 .. 0.805 (0.7 .. 0.9)"
    )
    assert lines[place + 1] == "    m0 0.8, m1 0.801, m2 0.802, m3 0.803, m4 0.804, m5 0.805"
    two = diagnosis_text(diagnosis(causes=causes[:2]))
    assert two.count("  cause torque_constant at") == 2


def test_of_an_effect_at_many_places_the_size_that_is_clearly_there_is_told_at_each():
    (cause,) = diagnosis()["causes"]
    stiffness = {"value": 0.01, "low": -0.1, "high": 0.1, "unit": "Nm/rad"}
    causes = [
        {
            **cause,
            "effect": "joint_spring",
            "location": name,
            "parameters": {
                "stiffness": stiffness,
                "preload": {"value": size, "low": 0.1, "high": 0.5, "unit": "Nm"},
            },
        }
        for name, size in (("hip", 0.2), ("knee", 0.3), ("ankle", 0.4))
    ]
    text = diagnosis_text(diagnosis(causes=causes))
    assert "\n    hip 0.2, knee 0.3, ankle 0.4 Nm" in text


def test_smallest_changes_stay_in_their_own_units():
    entries = [
        {"effect": "joint_spring", "location": place, "parameter": "stiffness", "change": size}
        | {"unit": unit}
        for place, size, unit in (
            ("ankle", 0.13, "Nm/rad"),
            ("rail", 0.5, "N/m"),
            ("hip", 0.76, "Nm/rad"),
        )
    ]
    assert sensitivity_rows({"sensitivity": entries}) == [
        ("joint_spring", "stiffness", "0.13 Nm/rad at ankle", "0.76 Nm/rad at hip"),
        ("joint_spring", "stiffness", "0.5 N/m at rail", ""),
    ]


def test_errors_of_slides_are_lengths():
    rows = [Replayed("hip", "rad", 0.002, 0.001, 5, "torque")]
    assert "error of position [mrad]:" in replayed_text(rows)
    both = replayed_text([*rows, Replayed("rail", "m", 0.004, 0.003, 5, "torque")])
    assert "error of position [mrad, mm]:" in both
    assert both.endswith("3 mm")


def test_what_references_lack_and_what_remains_is_told():
    lacking = {"verdict": "explained", "causes": [{**diagnosis()["causes"][0], "location": "hip"}]}
    lines = diagnosis_text(diagnosis(lacks=lacking, remainder=0.25)).splitlines()
    assert "  model lacks torque_constant at hip: p 0.90; scale 0.85 (0.84 .. 0.86)" in lines
    assert lines[0].endswith(" in part")
    assert "  remainder: 25 % of the gap, which no effect of the catalogue explains" in lines
    assert "lack" not in diagnosis_text(diagnosis(lacks=None))


def test_friction_of_a_reference_is_said_to_differ_from_day_to_day():
    odd = {"log": "monday", **diagnosis()["causes"][0], "effect": "coulomb_friction"}
    (line,) = (
        one
        for one in diagnosis_text(diagnosis(reference_differences=[odd])).splitlines()
        if "monday" in one
    )
    assert "differs from the others, as friction does from day to day; taken out of it:" in line


def test_a_reference_that_differs_is_told_before_the_causes():
    odd = {"log": "monday", **diagnosis()["causes"][0], "location": "hip"}
    lines = diagnosis_text(diagnosis(reference_differences=[odd])).splitlines()
    (line,) = (one for one in lines if "monday" in one)
    assert line.startswith("  reference monday differs from the others; taken out of it: torque_")
    assert lines.index(line) < min(i for i, one in enumerate(lines) if one.startswith("  cause"))


def test_without_a_cause_only_the_noise_is_told():
    found = diagnosis(verdict="none", causes=[], rivals=[], separating_experiment=None)
    assert diagnosis_text(found).splitlines()[1] == "residuals [Nm]: 0.5, of which noise 0.1"


def test_sizes_at_the_end_of_their_range_are_said_to_be():
    told = "torque_constant at hip, knee: scale 0.3 is at the end of the range that is tried"
    text = diagnosis_text(diagnosis(checks=[f"{told}, so something else may act there", "other"]))
    assert f"  {told}, so something else may act there" in text.splitlines()
    assert "other" not in text
