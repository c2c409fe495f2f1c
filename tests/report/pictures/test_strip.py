"""Strips show one gait cycle, and forces that carry the weight."""

from __future__ import annotations

import dataclasses

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.protocol import Events, WalkProtocol
from hyperleg_design.report.pictures import strip


def test_a_strip_has_a_row_a_walk_and_forces_that_carry_the_weight(walks):
    events = WalkProtocol().events
    scene = strip.strip_scene({name: (trial, events) for name, trial in walks.items()}, snapshots=5)
    labels = [text for _, text, _ in scene.labels]
    assert labels.count("0 %") == labels.count("50 %") == 2
    assert set(walks) <= set(labels)
    up = [vector[2] for _, vector, _ in scene.arrows]
    assert min(up) > 0
    weights = sum(up) / strip.FORCE_LENGTH
    assert 0.7 * 10 < weights < 1.3 * 10  # of ten snapshots, one body weight each in the mean
    for start, _, _ in scene.arrows:
        assert start[2] in (0.0, pytest.approx(-1.24))


def test_a_strip_needs_strides(walks):
    walk = walks["toe"]
    short = dataclasses.replace(
        walk,
        **{
            f: getattr(walk, f)[:60]
            for f in ("base_position", "base_orientation", "joint_position", "pad_force")
        },
    )
    with pytest.raises(InputError, match="too few strides"):
        strip.strip_scene({"toe": (short, Events())})
