"""Charts show the sizing room's numbers."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.gap.logs.recording import log_of_trial
from hyperleg_design.report.viewer import charts
from hyperleg_design.report.viewer.walk import RecordedWalk
from hyperleg_design.robot import transmission
from hyperleg_design.robot.load import load_robot
from hyperleg_design.sizing import zonotope
from hyperleg_design.sizing.envelope import motor_envelope


def test_an_envelope_spans_peak_torque_and_holds_the_recorded_points(walks):
    trial = walks["toe"]
    designs = {"toe": trial.design, "other": load_robot("toe_removed")}
    walk = RecordedWalk(log_of_trial(trial), trial.design)
    figure = charts.motor_chart(designs, "knee", walk, 10)
    first, second, left, now, right, _ = figure.data
    index = transmission.motor_names(trial.design).index("knee")
    peak = motor_envelope(trial.design).peak_torque[index]
    assert max(first.y) == pytest.approx(peak, abs=1e-3)
    assert min(second.y) == pytest.approx(-peak, abs=1e-3)
    assert set(left.y) <= set(walk.motor_points("left_knee")[1].round(3))
    assert right.name == "right knee"
    assert now.y[0] == walk.motor_points("left_knee")[1][10]


def test_a_motor_that_a_design_lacks_is_left_out():
    designs = {n: load_robot(n) for n in ("toe", "toe_removed")}
    assert len(charts.motor_chart(designs, "toe").data) == 1
    assert charts.motors_of(list(designs.values()))[-1] == "toe"


def test_slices_reach_what_one_joint_can_have_alone():
    design = load_robot("toe")
    filled, dotted = charts.slice_chart({"toe": design}, ("knee", "ankle_pitch")).data
    matrix, peak = transmission.joint_from_motor(design), motor_envelope(design).peak_torque
    rows = [transmission.joint_names(design).index(j) for j in ("knee", "ankle_pitch")]
    _, high = zonotope.box(matrix, -peak, peak)
    assert max(dotted.x) == pytest.approx(high[rows[0]], abs=2e-3)
    assert max(dotted.y) == pytest.approx(high[rows[1]], abs=2e-3)
    # the slice crosses the axis of the knee where the knee has what it can have alone
    x, y = np.array(filled.x), np.array(filled.y)
    cross = [
        x[i] - y[i] * (x[i + 1] - x[i]) / (y[i + 1] - y[i])
        for i in range(len(x) - 1)
        if (y[i] <= 0) != (y[i + 1] <= 0)
    ]
    alone = zonotope.alone(matrix, -peak, peak, rows[0])
    assert max(cross) == pytest.approx(float(alone), abs=0.05)


def test_pairs_share_motors_or_are_all():
    assert ("knee", "ankle_pitch") in charts.joint_pairs(load_robot("toe"))
    assert ("hip_yaw", "knee") not in charts.joint_pairs(load_robot("toe"))
    assert len(charts.joint_pairs(load_robot("mini_cheetah"))) == 3
