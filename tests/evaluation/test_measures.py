"""Measures have units and meanings."""

from __future__ import annotations

import pytest

from hyperleg_design.evaluation import measures, paper


def test_names_are_keys_and_meanings_are_given():
    for table in (measures.WALK, measures.T_TEST):
        for name, measure in table.items():
            assert measure.name == name
            assert measure.meaning
            assert measure.better in (measures.LESS, measures.MORE, measures.NEITHER)


def test_waypoints_have_times_and_others_are_unknown():
    assert measures.measure_of("waypoint_3").unit == "s"
    assert measures.measure_of("cadence").unit == "1/s"
    assert measures.measure_of("peak_speed").unit == "m/s"
    with pytest.raises(KeyError):
        measures.measure_of("no_such")


def test_what_the_paper_prints_is_measured_in_its_unit():
    for row in paper.TABLE_THREE:
        assert measures.WALK[row.measure].unit == row.unit
    for row in paper.TABLE_FOUR:
        assert measures.T_TEST[row.measure].unit == row.unit
