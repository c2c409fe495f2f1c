from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from hyperleg_design.gap.playback.evidence import Evidence
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.report.gap import figures as gap_figures

ARM = """
<mujoco><worldbody><body name="a" pos="0 0 0.3" euler="0 0 30">
  <joint name="pan" axis="0 0 1"/><inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/>
  <body name="b" pos="0.1 0 0.2" euler="0 40 0"><joint name="lift" axis="0 1 0" pos="0 0.02 0"/>
    <inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/>
    <body name="c" pos="0 0 0.4"><joint name="slide" type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/></body></body>
</body></worldbody></mujoco>
"""
CAUSE = {"effect": "payload", "location": "c", "probability": 0.9, "closed": 0.8, "parameters": {}}


def test_joints_are_drawn_where_mujoco_has_them(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    subject = load_subject(path)
    model = mujoco.MjModel.from_xml_string(ARM)
    data = mujoco.MjData(model)
    data.qpos[:] = subject.default
    mujoco.mj_kinematics(model, data)
    places, parents = gap_figures.joint_places(subject)
    np.testing.assert_allclose(places[:2], data.xanchor[:2], atol=1e-12)
    assert parents == [-1, 0, 1]
    assert gap_figures.robot_figure(subject, {"lift": 0.7, "c": 0.2}).axes


def test_the_waterfall_ends_where_the_gap_does() -> None:
    gap = {"before": 5.0, "after": 1.0, "floor": 0.5, "unit": "Nm"}
    figure = gap_figures.waterfall_figure(
        gap, [CAUSE, {**CAUSE, "effect": "backlash", "closed": 0.2}]
    )
    bars = figure.axes[0].patches
    assert [b.get_height() for b in bars] == pytest.approx([5.0, -3.2, -0.8, 1.0])
    assert bars[2].get_y() + bars[2].get_height() == pytest.approx(1.0)


def test_traces_show_the_row_with_the_largest_gap() -> None:
    time = np.arange(2000) * 0.005
    before = np.column_stack([0.1 * np.sin(time), 2.0 * np.sin(3 * time)])
    shown = Evidence(
        "run", "motion", ("small", "large"), time, before, 0.5 * before, np.cos(before)
    )
    figure = gap_figures.trace_figure(shown)
    assert figure.axes[0].get_title() == "large, run"
    measured, predicted, left = (line.get_ydata() for line in figure.axes[0].lines)
    np.testing.assert_allclose(np.asarray(predicted) + np.asarray(left), measured)
