import numpy as np
import pytest
import yaml
from hypothesis import example, given, settings
from hypothesis import strategies as st

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.sweep.space import MAX_DESIGNS, load_sweep, sweep_from_mapping

AXES = {
    "toe.mass": {"low": 0.1, "high": 0.5},
    "leg": {"paths": ["thigh.length", "shank.length"], "scale": {"low": 0.8, "high": 1.2}},
}
GRID = {
    "toe.mass": {"values": [0.1, 0.3]},
    "actuators.knee.motor": {"values": ["RI60", "RI70", "RI80"]},
}


def sampled(sampling="sobol", count=16, seed=0, **more):
    return sweep_from_mapping(
        {
            "design": "hyperleg",
            "sampling": sampling,
            "count": count,
            "seed": seed,
            "axes": AXES,
            **more,
        }
    )


@pytest.mark.parametrize("name", resources.names("sweeps"))
def test_shipped_sweeps_read(name):
    sweep = load_sweep(name)
    assert sweep.name == name
    assert sweep.description
    assert 0 < sweep.size < 20_000


def test_only_a_passive_toes_spring_can_be_swept():
    axes = {"toe.stiffness": {"values": [5.0, 20.0]}}
    sweep = sweep_from_mapping({"design": "hyperleg", "variants": ["toe_passive"], "axes": axes})
    designs = sweep.design(sweep.samples(), "toe_passive")
    np.testing.assert_array_equal(designs["toe.stiffness"], [5.0, 20.0])
    assert designs["toe.joint"] == "passive"
    with pytest.raises(InputError, match="only toe_passive has a spring"):
        sweep_from_mapping({"design": "hyperleg", "variants": ["toe"], "axes": axes})


def test_set_and_overrides_change_the_base():
    data = {"design": "hyperleg", "set": {"foot.mass": 0.7}, "axes": GRID}
    assert sweep_from_mapping(data).base.foot.mass == 0.7
    changed = sweep_from_mapping(data, overrides={"foot.mass": 0.8})
    assert changed.base.foot.mass == 0.8
    assert changed.digest() != sweep_from_mapping(data).digest()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"axis": {}}, ["axis", "did you mean axes"]),
        ({"samples": 12}, ["samples", "There are axes, count, description"]),
        ({"design": None}, ["design", "is missing"]),
        ({"design": "hyperlegg"}, ["hyperlegg", "did you mean hyperleg?"]),
        ({"design": "toe_removed"}, ["toe_removed", "variants"]),
        ({"design": 3}, ["design", "name of a design"]),
        ({"axes": None}, ["axes", "is missing"]),
        ({"axes": {}}, ["at least one axis"]),
        ({"axes": [1]}, ["at least one axis"]),
        ({"axes": {"toe.mas": {"values": [1]}}}, ["axes.toe.mas", "did you mean toe.mass"]),
        ({"axes": {"variant": {"paths": ["toe.mass"], "values": [1]}}}, ["another column"]),
        (
            {"axes": {"a": {"paths": ["toe.mass"], "values": [1]}, "toe.mass": {"values": [1]}}},
            ["moved by the axis a"],
        ),
        ({"sampling": "halton"}, ["sampling", "grid, random, sobol"]),
        ({"sampling": "sobol"}, ["count", "is missing"]),
        ({"sampling": "sobol", "count": 0}, ["count", "1 .."]),
        ({"sampling": "sobol", "count": True}, ["count"]),
        ({"sampling": "sobol", "count": MAX_DESIGNS + 1}, ["count"]),
        ({"count": 4}, ["count", "grid"]),
        ({"seed": -1}, ["seed", "0 .."]),
        ({"seed": 1.5}, ["seed", "whole number"]),
        ({"variants": []}, ["variants", "toe_locked"]),
        ({"variants": ["toe_lokced"]}, ["did you mean toe_locked"]),
        ({"variants": ["toe", "toe"]}, ["different"]),
        ({"set": ["toe.mass=1"]}, ["set", "mapping"]),
        ({"set": {"toe.mas": 1}}, ["toe.mas", "did you mean"]),
        ({"measures": ["leg_mas"]}, ["did you mean leg_mass"]),
        ({"measures": []}, ["measures"]),
        ({"objectives": ["max_joint_torque"]}, ["objectives", "max_joint_torque"]),
        ({"objectives": "leg_mass"}, ["list of measures"]),
        (
            {"maps": [{"x": "toe.mass", "y": "toe.mass", "measure": "leg_mass"}]},
            ["maps.x", "different"],
        ),
        ({"maps": [{"x": "actuators.knee.motor", "measure": "leg_mass"}]}, ["numeric axes"]),
        ({"maps": [{"x": "toe.mass", "measure": "leg_mas"}]}, ["did you mean leg_mass"]),
        ({"maps": [{"x": "toe.mass"}]}, ["maps", "measure"]),
    ],
)
def test_what_is_wrong_is_named(change, words):
    data = {"design": "hyperleg", "axes": GRID} | change
    data = {k: v for k, v in data.items() if v is not None}
    with pytest.raises(InputError) as caught:
        sweep_from_mapping(data, "sweeps/x.yaml")
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message, message


def test_a_grid_of_millions_is_a_mistake():
    axes = {
        name: {"low": 0.9, "high": 1.1, "steps": 1000}
        for name in ("thigh.length", "shank.length", "pelvis.height")
    }
    with pytest.raises(InputError, match="sample with sobol"):
        sweep_from_mapping({"design": "hyperleg", "axes": axes})


BROKEN = [
    "axes: [",
    "axes: {toe.mass: {values: [1]}, toe.mass: {values: [2]}}",
    "- 1",
    "design: hyperleg\naxes:\n  toe.mass: 1",
]


@pytest.mark.parametrize("text", BROKEN)
def test_broken_files_are_one_clear_error(tmp_path, text):
    path = tmp_path / "broken.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=r"broken\.yaml") as caught:
        load_sweep(path)
    assert "\n" not in str(caught.value)


def test_a_missing_file_lists_the_shipped_ones():
    with pytest.raises(InputError, match="toe_mass"):
        load_sweep("no_such_sweep")


LEAVES = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8)
KEYS = st.sampled_from(["toe.mass", "values", "low", "high", "steps", "scale", "paths"])
ANYTHING = st.recursive(
    LEAVES, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner), max_leaves=8
)
FIELDS = ["axes", "variants", "sampling", "count", "seed", "measures", "objectives", "maps", "set"]


@given(data=ANYTHING, field=st.sampled_from(FIELDS))
@example(data=True, field="maps")
@settings(max_examples=150, deadline=None)
def test_anything_else_is_refused_or_read_never_a_crash(data, field):
    """A field of any shape gives a sweep or an InputError."""
    try:
        sweep = sweep_from_mapping({"design": "hyperleg", "axes": GRID} | {field: data})
    except InputError:
        return
    yaml.safe_dump(sweep.to_mapping())
