import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.report.sizing.demand_figures import (
    capability_figure,
    cycle_figure,
    margin_figure,
    operating_points_figure,
)
from hyperleg_design.report.style import save
from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing.capability import capability_table
from hyperleg_design.sizing.demand import demand
from hyperleg_design.sizing.motions.reference import reference_motion


@pytest.fixture(scope="module")
def walks():
    design = load_design()
    found = {}
    for name in ("toe", "toe_removed_matched"):
        variant = ablate(design, name)
        found[name] = demand(variant, reference_motion(variant, "walk", samples=61))
    return found


def test_cycle_shows_angles_and_torques_of_every_robot(walks):
    figure = cycle_figure(walks)
    titles = [a.get_title() for a in figure.axes if a.get_title()]
    assert titles == ["hip roll", "hip pitch", "knee", "ankle pitch", "ankle roll", "toe"]
    knee = figure.axes[2]
    curves = [line for line in knee.lines if len(line.get_xdata()) == 61]
    assert len(curves) == 2
    np.testing.assert_allclose(
        curves[0].get_ydata(), np.rad2deg(walks["toe"].motion.joint_position[:, 0, 3])
    )
    assert len([line for line in figure.axes[5].lines if len(line.get_xdata()) == 61]) == 1


def test_operating_points_lie_inside_the_drawn_envelope(walks):
    figure = operating_points_figure(walks)
    for axes in figure.axes[:7]:
        upper, lower = axes.lines[0], axes.lines[1]
        for points in axes.collections[1:]:
            speed, torque = np.asarray(points.get_offsets()).T
            assert np.all(torque <= np.interp(speed, upper.get_xdata(), upper.get_ydata()) + 0.02)
            assert np.all(torque >= np.interp(speed, lower.get_xdata(), lower.get_ydata()) - 0.02)
    assert len(figure.axes[6].collections) == 2  # envelope and the one robot that has a toe motor


def test_margin_bars_are_the_table(walks):
    axes = margin_figure(walks).axes[0]
    heights = sorted(p.get_height() for p in axes.patches)
    wanted = sorted(row["margin_over_peak"] for d in walks.values() for row in d.table())
    np.testing.assert_allclose(heights, wanted)


def test_capability_bars_are_the_rows():
    rows = capability_table({"toe": load_design()}, ("standing", "mid_squat"))
    rows.append(
        {
            "design": "toe",
            "posture": "straight",
            "direction": "vertical",
            "force": None,
            "reason": "none",
        }
    )
    figure = capability_figure(rows)
    heights = [p.get_height() for a in figure.axes for p in a.patches]
    np.testing.assert_allclose(
        sorted(heights), sorted(r["body_weights"] for r in rows if r["force"])
    )


def test_pictures_are_written(walks, tmp_path):
    assert (
        save(operating_points_figure(walks), tmp_path / "points.png", dpi=50).stat().st_size > 5000
    )


def test_nothing_to_draw(walks):
    with pytest.raises(InputError, match="at least one"):
        margin_figure({})
    with pytest.raises(InputError, match="at least one"):
        capability_figure([])
    design = load_design()
    with pytest.raises(InputError, match="one motion"):
        cycle_figure({"a": walks["toe"], "b": demand(design, "squat")})
