"""Stick figures stand where the motion has the robot."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.report.sizing.stick_figures import stick_figure_strip
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing.demand import demand
from hyperleg_design.sizing.motions.reference import reference_motion


@pytest.fixture(scope="module")
def walk():
    design = load_design()
    return demand(design, reference_motion(design, "walk", samples=61))


def test_strip_draws_the_robot_where_the_motion_has_it(walk):
    axes = stick_figure_strip(walk, frames=4, spacing=0.0).axes[0]
    legs = [line for line in axes.lines if len(line.get_xdata()) == 3 and line.get_linewidth() == 4]
    assert len(legs) == 8
    for line, n in zip(legs[::2], (0, 15, 30, 46), strict=True):
        hip = walk.motion.model.frame_position(walk.motion.q[n], "left_thigh")
        np.testing.assert_allclose(
            [line.get_xdata()[0], line.get_ydata()[0]], hip[[0, 2]], atol=1e-12
        )
        assert 0.3 < hip[2] < 0.8
    assert "planned" in axes.get_title(loc="left")


def test_one_frame_is_no_strip(walk):
    with pytest.raises(InputError, match="at least 2"):
        stick_figure_strip(walk, frames=1)
