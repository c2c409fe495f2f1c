import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.motors import catalogue
from hyperleg_design.sweep.spaces.axis import Axis, read_axis

BASE = load_design("hyperleg")


def read(name, data, grid=True):
    return read_axis(name, data, BASE, "sweeps/x.yaml", grid=grid)


def test_a_range_has_levels_ends_included():
    axis = read("toe.mass", {"low": 0.1, "high": 0.5, "steps": 5})
    np.testing.assert_allclose(axis.levels, [0.1, 0.2, 0.3, 0.4, 0.5])
    assert axis.unit == "kg"
    assert axis.label == "toe.mass [kg]"


def test_log_levels_are_evenly_spaced_in_the_logarithm():
    axis = read("actuators.knee.gear", {"low": 2, "high": 32, "steps": 5, "log": True})
    np.testing.assert_allclose(axis.levels, [2, 4, 8, 16, 32])


def test_scale_multiplies_each_base_value_vectors_too():
    axis = read(
        "foot", {"paths": ["thigh.length", "shank.length", "foot.com"], "scale": [0.5, 2.0]}
    )
    found = axis.leaf_values(BASE, np.array([0.5, 2.0]))
    np.testing.assert_allclose(
        found["thigh.length"], [0.5 * BASE.thigh.length, 2 * BASE.thigh.length]
    )
    np.testing.assert_allclose(found["foot.com"], [0.5 * BASE.foot.com, 2 * BASE.foot.com])


def test_several_paths_share_a_value():
    axis = read(
        "gear", {"paths": ["actuators.knee.gear", "actuators.ankle.gear"], "values": [5, 9]}
    )
    found = axis.leaf_values(BASE, np.array([5.0, 9.0]))
    assert set(found) == {"actuators.knee.gear", "actuators.ankle.gear"}
    np.testing.assert_array_equal(found["actuators.ankle.gear"], [5, 9])


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("actuators.hip_*.gear", {"values": [5, 9]}),
        ("hips", {"paths": ["actuators.hip_*.gear", "actuators.hip_yaw.gear"], "values": [5, 9]}),
    ],
)
def test_a_pattern_moves_every_leaf_that_matches_once(name, data):
    axis = read(name, data)
    assert axis.name == name
    assert axis.paths == tuple(f"actuators.hip_{j}.gear" for j in ("yaw", "roll", "pitch"))


def test_the_whole_catalogue():
    assert read("actuators.toe.motor", {"values": "catalogue"}).levels == tuple(sorted(catalogue()))


@given(
    low=st.floats(1e-3, 10),
    width=st.floats(1e-3, 10),
    log=st.booleans(),
    position=st.lists(st.floats(0, 1, exclude_max=True), min_size=1, max_size=20),
)
@settings(max_examples=50, deadline=None)
def test_positions_stay_inside_and_in_order(low, width, log, position):
    axis = Axis("a", ("toe.mass",), (), low, low + width, log)
    values = axis.at(np.sort(position))
    assert np.all((values >= low) & (values <= low + width))
    assert np.all(np.diff(values) >= -1e-12)


@given(count=st.integers(1, 9))
@settings(max_examples=20, deadline=None)
def test_listed_values_are_drawn_evenly(count):
    axis = Axis("a", ("toe.mass",), tuple(float(i) for i in range(count)))
    drawn = axis.at((np.arange(count * 50) + 0.5) / (count * 50))
    np.testing.assert_array_equal(np.bincount(drawn.astype(int)), np.full(count, 50))


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        ("toe.mas", {"values": [0.1]}, ["axes.toe.mas", "did you mean toe.mass"]),
        ("reductions", {"values": [1]}, ["axes.reductions", "paths"]),
        ("toe", {"values": [1]}, ["axes.toe", "paths"]),
        (
            "a",
            {"paths": ["thigh.lenght"], "values": [1]},
            ["thigh.lenght", "did you mean thigh.length"],
        ),
        ("a", {"paths": [], "values": [1]}, ["axes.a.paths"]),
        ("a", {"paths": ["toe.mass", "toe.mass"], "values": [1]}, ["different leaves"]),
        ("toe.mass", [0.1, 0.2], ["axes.toe.mass", "mapping"]),
        ("toe.mass", {"value": [0.1]}, ["axes.toe.mass.value", "did you mean values"]),
        ("toe.mass", {"values": []}, ["at least one"]),
        ("toe.mass", {"values": [0.1, 0.1]}, ["twice"]),
        ("toe.mass", {"values": [0.1, "heavy"]}, ["axes.toe.mass.values", "'heavy'", "number"]),
        ("toe.mass", {"values": [0.1, float("nan")]}, ["finite"]),
        ("toe.mass", {"values": [0.1, 220]}, ["220", "0 .. 10 kg", "unit"]),
        ("toe.mass", {"values": [0.1], "low": 0.1}, ["not both"]),
        ("toe.mass", {"low": 0.1, "steps": 3}, ["axes.toe.mass.high", "is missing"]),
        ("toe.mass", {"low": 0.5, "high": 0.1, "steps": 3}, ["below high"]),
        ("toe.mass", {"low": -0.5, "high": 0.1, "steps": 3}, ["-0.5", "sign"]),
        ("toe.mass", {"low": 0.0, "high": 0.1, "steps": 3, "log": True}, ["positive where log"]),
        ("toe.mass", {"low": 0.1, "high": 0.5}, ["axes.toe.mass.steps", "is missing"]),
        ("toe.mass", {"low": 0.1, "high": 0.5, "steps": 1}, ["2 .."]),
        ("toe.mass", {"low": 0.1, "high": 0.5, "steps": 2.5}, ["whole number"]),
        ("toe.mass", {"low": 0.1, "high": 0.5, "steps": 3, "log": "yes"}, ["true or false"]),
        (
            "toe.mass",
            {"scale": {"low": 0.1, "high": 0.5, "step": 3}},
            ["axes.toe.mass.scale.step", "did you mean steps"],
        ),
        ("toe.mass", {"scale": {"values": [1]}, "low": 1}, ["inside scale"]),
        ("toe.mass", {"scale": 2}, ["of the factor"]),
        ("toe.mass", {"scale": [1, 100]}, ["toe.mass takes 0 .. 10 kg"]),
        ("toe.com", {"values": [1]}, ["vector", "scale"]),
        ("actuators.knee.motor", {"values": ["RI7O"]}, ["no such motor", "RI70"]),
        ("actuators.knee.motor", {"scale": [1, 2]}, ["nothing to scale"]),
        ("toe.joint", {"values": ["locked"]}, ["cannot vary within a sweep", "variants"]),
        ("transmission.posture", {"values": ["walking"]}, ["cannot vary within a sweep"]),
        ("actuators.toe_installed", {"values": [True]}, ["cannot vary within a sweep"]),
        ("reference.knee_motor", {"values": ["RI60"]}, ["cannot vary within a sweep"]),
        ("a", {"paths": ["toe.mass", "toe.length"], "values": [0.1]}, ["different units"]),
    ],
)
def test_what_is_wrong_is_named(name, data, words):
    with pytest.raises(InputError) as caught:
        read(name, data)
    message = str(caught.value)
    assert "\n" not in message
    for word in ["sweeps/x.yaml", *words]:
        assert word in message, message


def test_sampled_ranges_need_no_steps():
    axis = read("toe.mass", {"low": 0.1, "high": 0.5}, grid=False)
    assert axis.levels == ()
    assert axis.numeric
