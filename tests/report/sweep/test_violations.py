"""A search without a design that holds all constraints says which of them stand in the way."""

from __future__ import annotations

from types import SimpleNamespace

from hyperleg_design.report.sweep.violations import violations
from hyperleg_design.sweep.search import ROW
from hyperleg_design.sweep.searching.constraint import read_constraint, usual_constraints


def search_with(constraints, protocols):
    sweep = SimpleNamespace(axes=(SimpleNamespace(name="toe.mass"),))
    return SimpleNamespace(sweep=sweep, constraints=constraints, protocols=protocols)


def study_of(*rows):
    attributes = [{ROW: {"sample": i, "toe.mass": 0.2, **row}} for i, row in enumerate(rows)]
    return SimpleNamespace(trials=[SimpleNamespace(user_attrs=a) for a in [{}, *attributes]])


def test_the_design_that_violates_least_and_the_bounds_that_it_holds():
    rest = {"walk.limit_share": 0.0}
    study = study_of(
        {"walk.arrived": 0.1, "walk.thermal_peak": 0.5, **rest},
        {"walk.arrived": 0.8766, "walk.thermal_peak": 1.5, **rest},
        {"walk.arrived": None, "walk.thermal_peak": 0.5, **rest},
    )
    text = violations(search_with(usual_constraints(["walk"]), ["walk"]), study)
    assert text[0] == "constraints (those by default):"
    counts = [line.split() for line in text[1].splitlines()[2:]]
    assert counts == [
        ["walk.arrived>=0.95", "0", "2"],
        ["walk.thermal_peak<=1", "1", "2"],
        ["walk.limit_share<=0.05", "2", "2"],
    ]
    nearest = [line.split() for line in text[3].splitlines()[2:]]
    assert nearest[0] == ["1", "0.2", "0.8766", "*", "1.5", "*", "0"]
    assert nearest[1][0] == "0"
    for bound in ("walk.arrived>=0.876", "walk.thermal_peak<=1.5", "walk.limit_share<=0.05"):
        assert f"--constraint '{bound}'" in text[4]
        values = {"walk.arrived": 0.8766, "walk.thermal_peak": 1.5, "walk.limit_share": 0.0}
        relaxed = read_constraint(bound, ["walk"])
        assert relaxed.violation(values[relaxed.name]) <= 0


def test_a_lower_bound_and_a_study_without_measures():
    search = search_with((read_constraint("total_mass>=40", []),), [])
    assert (
        "--constraint 'total_mass>=32.1'" in violations(search, study_of({"total_mass": 32.16}))[4]
    )
    assert violations(search, study_of({"total_mass": None})) == []


def test_a_lower_bound_moves_to_none_where_the_nearest_design_has_none():
    search = search_with((read_constraint("walk.arrived>=0.95", ["walk"]),), ["walk"])
    text = violations(search, study_of({"walk.arrived": 0.0}))[4]
    assert text.endswith("design 0 holds --constraint 'walk.arrived>=0'")
