"""Cuts and bodies that are drawn are those of the torque set."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.report.sizing import slice_figures
from hyperleg_design.report.style import save
from hyperleg_design.robot import transmission
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing import slices, zonotope
from hyperleg_design.sizing.envelope import motor_envelope


@pytest.fixture(scope="module")
def design():
    return load_design("hyperleg")


def test_cuts_are_drawn_where_the_joint_exists(design):
    from matplotlib.patches import Polygon

    figure = slice_figures.slice_figure(design, pitch_speeds=(0.0,), posture="walking")
    assert len(figure.axes) == 6
    with_toe, without = figure.axes[1], figure.axes[4]
    assert [t.get_text() for t in without.texts] == ["no toe joint"]
    matrix, peak = (
        transmission.joint_from_motor(design, "walking")[3:, 3:],
        motor_envelope(design).peak_torque[3:],
    )
    drawn = [p.get_xy()[:-1] for p in with_toe.patches if isinstance(p, Polygon)]
    expected = slices.slice_polygon(matrix, -peak, peak, (3, 1))
    assert any(len(d) == len(expected) and np.allclose(d, expected) for d in drawn)
    assert len(slice_figures.slice_figure(load_design("hyperleg", variant="toe_locked")).axes) == 3


def test_body_says_how_much_of_its_box_it_fills(design):
    figure = slice_figures.polyhedron_figure(design, (0.0,), posture="walking")
    matrix, peak = (
        transmission.joint_from_motor(design, "walking")[3:, 3:],
        motor_envelope(design).peak_torque[3:],
    )
    low, high = zonotope.box(matrix, -peak, peak)
    share = (
        slices.slice_polyhedron(matrix, -peak, peak, (0, 3, 1)).volume
        / (high - low)[[0, 1, 3]].prod()
    )
    assert f"{100 * share:.1f} %" in figure.axes[0].get_title()


@pytest.mark.parametrize(
    "variant", ["toe", pytest.param("toe_locked", marks=pytest.mark.slow), "toe_removed_matched"]
)
def test_every_variant_can_be_drawn_and_saved(variant, tmp_path):
    robot = load_design("hyperleg", variant=variant)
    for name in ("slice_figure", "polyhedron_figure"):
        figure = getattr(slice_figures, name)(robot)
        for ending in ("png", "svg"):
            assert save(figure, tmp_path / f"{name}.{ending}", dpi=40).stat().st_size > 4000


def test_bad_input_is_refused(design):
    batch = design.with_values({"toe.mass": np.array([0.2, 0.3])})
    for draw in (slice_figures.slice_figure, slice_figures.polyhedron_figure):
        with pytest.raises(InputError, match="batch"):
            draw(batch)
    with pytest.raises(InputError, match="speeds"):
        slice_figures.slice_figure(design, pitch_speeds=(0, 1, 2, 3))
    with pytest.raises(InputError, match="variant"):
        slice_figures.slice_figure(design, variants=("tow",))
