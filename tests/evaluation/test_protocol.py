"""Protocols read back what they write, the shipped ones are the paper's, and nonsense is one clear
error.
"""

from __future__ import annotations

import pytest
import yaml

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import paper
from hyperleg_design.evaluation.protocol import (
    TTestProtocol,
    WalkProtocol,
    load_protocol,
    protocol_from_mapping,
    protocol_mapping,
)
from hyperleg_design.resources import sim_names


def test_the_shipped_walk_is_the_papers():
    walk = load_protocol("walk")
    assert isinstance(walk, WalkProtocol)
    assert (walk.speed, walk.distance, walk.trials) == (
        paper.WALK_SPEED,
        paper.WALK_DISTANCE,
        paper.TRIALS,
    )
    assert walk.impact.window == 0.05


def test_the_shipped_t_test_is_the_papers_course():
    run = load_protocol("t_test")
    assert isinstance(run, TTestProtocol)
    assert "".join(run.order) == "ABCDBA"
    assert run.trials == paper.TRIALS
    assert run.course.tolist() == [
        [0, 0],
        [9.14, 0],
        [9.14, 4.57],
        [9.14, -4.57],
        [9.14, 0],
        [0, 0],
    ]


@pytest.mark.parametrize("name", ["walk", "t_test"])
def test_a_protocol_reads_back_what_it_writes(name):
    protocol = load_protocol(name)
    mapping = protocol_mapping(protocol)
    again = protocol_from_mapping(yaml.safe_load(yaml.safe_dump(mapping)), "again")
    assert protocol_mapping(again) == mapping


def test_defaults_are_the_shipped_ones_but_for_times():
    shipped, default = (
        protocol_mapping(load_protocol("walk")),
        protocol_mapping(WalkProtocol(time_limit=30.0)),
    )
    default["steady"]["end"] = 20.0
    assert shipped == default


def test_a_users_file_is_found_beside_the_shipped(write):
    path = write(
        "mine.yaml", "{kind: walk, speed: 1.0, distance: 5.0, trials: 2, steady: {begin: 1.0}}"
    )
    assert load_protocol(path).steady_end == 5.0
    assert set(sim_names("protocol")) >= {"walk", "t_test"}


@pytest.mark.parametrize(
    ("text", "field", "remedy"),
    [
        ("{kind: run}", "kind", "walk, t_test"),
        ("{speed: 1.0}", "kind", "walk, t_test"),
        ("{kind: walk, sped: 1.0}", "sped", "did you mean speed"),
        ("{kind: walk, speed: fast}", "speed", "a number in m/s"),
        ("{kind: walk, speed: -1.0}", "speed", "within"),
        ("{kind: walk, trials: 2.5}", "trials", "whole number"),
        ("{kind: walk, trials: 0}", "trials", "within"),
        ("{kind: walk, speed: 0.1}", "distance", "cannot be reached"),
        ("{kind: walk, steady: {begin: 30.0}}", "steady", "begin below end"),
        ("{kind: walk, steady: {end: 30.0}}", "steady", "within distance"),
        ("{kind: walk, start: {tillt: 1}}", "start.tillt", "did you mean tilt"),
        ("{kind: walk, start: 3}", "start", "mapping"),
        ("{kind: walk, order: [A]}", "order", "no such field"),
        ("{kind: walk, events: {lift_load: 0.5}}", "events.lift_load", "touchdown_load"),
        ("{kind: walk, impact: {order: 3}}", "impact.order", "2, 4, 6 or 8"),
        ("{kind: t_test, order: [A]}", "order", "at least two"),
        ("{kind: t_test, order: [A, E]}", "order", "is not among points"),
        ("{kind: t_test, order: [A, A]}", "order", "unreachable"),
        ("{kind: t_test, order: A}", "order", "list of names"),
        ("{kind: t_test, arrival: 4.6}", "order", "unreachable"),
        ("{kind: t_test, points: {A: [0, 0], B: [0.3, 0]}, order: [A, B]}", "order", "unreachable"),
        (
            "{kind: t_test, points: {A: [0, 0], B: [900, 0]}, order: [A, B]}",
            "time_limit",
            "too short",
        ),
        (
            "{kind: t_test, points: {A: [0, 0], B: far}, order: [A, B]}",
            "points.B",
            "vector of 2 numbers",
        ),
        ("{kind: t_test, points: {A: [0, .nan]}}", "points.A", "finite"),
        ("{kind: t_test, points: []}", "points", "names with places"),
    ],
)
def test_nonsense_names_file_field_and_remedy(write, text, field, remedy):
    with pytest.raises(InputError) as caught:
        load_protocol(write("mine.yaml", text))
    assert caught.value.field == field
    assert remedy in caught.value.remedy
    assert "mine.yaml" in caught.value.where


def test_a_missing_protocol_lists_the_shipped():
    with pytest.raises(InputError, match="t_test, t_test_fast, walk"):
        load_protocol("zzz")
    with pytest.raises(InputError, match=r"did you mean walk\?"):
        load_protocol("wlk")
