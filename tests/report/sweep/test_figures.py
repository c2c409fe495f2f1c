import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.report.sweep import figures as sweep_figures
from hyperleg_design.report.sweep.rows import base_level, thinned
from hyperleg_design.sweep import measures
from hyperleg_design.sweep.run import run_sweep
from hyperleg_design.sweep.space import Map, sweep_from_mapping

AXES = {
    "toe.mass": {"low": 0.1, "high": 0.5, "steps": 5},
    "knee": {"paths": ["transmission.scale.knee"], "scale": {"low": 0.6, "high": 1.6, "steps": 6}},
    "actuators.knee.motor": {"values": ["RI60", "RI70"]},
}
DEFINITION = {
    "name": "figures",
    "design": "hyperleg",
    "variants": ["toe", "toe_removed_matched"],
    "axes": AXES,
    "objectives": ["swing_inertia", "squat_heat", "push_off_power"],
    "maps": [
        {"x": "toe.mass", "y": "knee", "measure": "squat_heat"},
        {"x": "knee", "measure": "max_joint_torque.toe"},
    ],
}


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    return run_sweep(
        sweep_from_mapping(DEFINITION), tmp_path_factory.mktemp("grid") / "out", progress=False
    )


@pytest.fixture(scope="module")
def sampled(tmp_path_factory):
    definition = DEFINITION | {
        "sampling": "sobol",
        "count": 64,
        "objectives": ["swing_inertia", "squat_heat"],
    }
    definition["axes"] = AXES | {"toe.mass": {"low": 0.1, "high": 0.5, "log": True}}
    return run_sweep(
        sweep_from_mapping(definition), tmp_path_factory.mktemp("sampled") / "out", progress=False
    )


def test_all_that_the_definition_asks_for_is_drawn_the_same_each_time(grid, tmp_path):
    first = sweep_figures.draw_sweep(grid, tmp_path / "a")
    assert list(first) == [
        "figures-map-1.png",
        "figures-map-2.png",
        "figures-pareto.png",
        "figures-parallel.png",
    ]
    again = sweep_figures.draw_sweep(grid, tmp_path / "b")
    for name in first:
        content = (tmp_path / "a" / name).read_bytes()
        assert content.startswith(b"\x89PNG")
        assert content == (tmp_path / "b" / name).read_bytes()
    assert again == first
    assert "actuators.knee.motor at RI70" in first["figures-map-1.png"]


def test_sampled_sweeps_are_drawn_too(sampled, tmp_path):
    made = sweep_figures.draw_sweep(sampled, tmp_path)
    assert len(made) == 4
    assert "Medians" in made["figures-map-1.png"]


def test_a_map_shows_the_table_at_the_base_of_the_other_axes(grid):
    figure = sweep_figures.map_figure(grid, Map("toe.mass", "knee", "squat_heat"))
    columns = grid.columns()
    for panel, variant in zip(figure.axes, ("toe", "toe_removed_matched"), strict=False):
        assert panel.get_title() == variant.replace("_", " ")
        assert panel.get_xlabel() == "toe.mass [kg]"
        rows = (columns["variant"] == variant) & (columns["actuators.knee.motor"] == "RI70")
        drawn = np.sort(np.ravel(panel.collections[0].get_array()))
        np.testing.assert_array_equal(drawn, np.sort(columns["squat_heat"][rows]))
    assert figure.axes[-1].get_ylabel() == "squat heat [W]"


def test_a_curve_has_a_line_for_each_variant_that_has_the_measure(grid):
    figure = sweep_figures.curve_figure(grid, Map("knee", "", "max_joint_torque.toe"))
    lines = [line for line in figure.axes[0].lines if line.get_linestyle() == "-"]
    assert [line.get_label() for line in lines] == ["toe"]
    assert len(lines[0].get_xdata()) == 6


def test_pareto_panels_are_the_pairs_of_objectives(grid):
    figure = sweep_figures.pareto_figure(grid)
    labels = [
        (a.get_xlabel().split(" [")[0], a.get_ylabel().split(" [")[0])
        for a in figure.axes
        if a.get_visible()
    ]
    assert labels == [
        ("swing inertia", "squat heat"),
        ("swing inertia", "push off power"),
        ("squat heat", "push off power"),
    ]
    assert "higher is better" in figure.axes[1].get_ylabel()


def test_a_measure_that_no_variant_has_is_refused(tmp_path):
    sweep = sweep_from_mapping(
        DEFINITION
        | {
            "variants": ["toe_removed"],
            "maps": [],
            "objectives": ["max_joint_torque.toe", "leg_mass"],
        }
    )
    result = run_sweep(sweep, tmp_path / "out", progress=False)
    with pytest.raises(InputError, match=r"max_joint_torque\.toe"):
        sweep_figures.map_figure(result, Map("toe.mass", "knee", "max_joint_torque.toe"))
    with pytest.raises(InputError, match="objectives"):
        sweep_figures.pareto_figure(result)


def test_levels_nearest_to_the_unchanged_design(grid):
    levels = {axis.name: base_level(axis, grid.sweep) for axis in grid.sweep.axes}
    assert levels == {
        "toe.mass": pytest.approx(0.2),
        "knee": pytest.approx(1.0),
        "actuators.knee.motor": "RI70",
    }


def test_thinning_keeps_both_ends():
    assert thinned(3, 10).tolist() == [0, 1, 2]
    kept = thinned(1000, 10)
    assert (len(kept), kept[0], kept[-1]) == (10, 0, 999)


def test_every_measure_has_a_readable_label():
    for column in measures.columns(measures.MEASURES):
        assert "_" not in measures.label(column)
        assert "^2" not in measures.label(column)
