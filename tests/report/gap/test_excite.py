from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.experiments.excite import design_experiment
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.report.gap.excite import (
    motions_figure,
    plan_text,
    separation_figure,
    write_report,
)

PENDULUM = """
<mujoco model="pendulum">
  <worldbody>
    <body name="arm" pos="0 0 1">
      <joint name="swing" axis="0 1 0" damping="0.02" armature="0.003"/>
      <inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.0006 0.0006 0.0001"/>
    </body>
  </worldbody>
  <actuator><motor name="servo" joint="swing" ctrlrange="-3 3"/></actuator>
</mujoco>
"""
SLIDE = """
      <joint name="lift" type="slide" axis="0 0 1" range="-0.2 0.3" damping="2" armature="0.2"/>
      <inertial pos="0 0 0" mass="2" diaginertia="0.01 0.01 0.01"/>"""
LIFT = f"""
<mujoco model="lift">
  <worldbody>
    <body name="carriage" pos="0 0 1">{SLIDE}
      <body name="arm">
        <joint name="swing" axis="0 1 0" range="-70 70" damping="0.02" armature="0.003"/>
        <inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.0006 0.0006 0.0001"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="hoist" joint="lift" ctrlrange="-80 80"/>
    <motor name="servo" joint="swing" ctrlrange="-3 3"/>
  </actuator>
</mujoco>
"""
ALONE = f"""
<mujoco model="alone">
  <worldbody><body name="carriage" pos="0 0 1">{SLIDE}</body></worldbody>
  <actuator><motor name="hoist" joint="lift" ctrlrange="-80 80"/></actuator>
</mujoco>
"""


def drawn(tmp_path, model):
    """A plan of one motion, 0.1 rad or m at each joint, and the axes of its figure."""
    path = tmp_path / "model.xml"
    path.write_text(model)
    subject = load_subject(str(path))
    time = np.linspace(0.0, 1.0, 11)
    motion = SimpleNamespace(
        name="sweep",
        time=time,
        position=np.full((len(time), len(subject.joints)), 0.1),
        off=np.zeros(len(time), bool),
    )
    return motions_figure(SimpleNamespace(subject=subject, motions=[motion], chosen=("sweep",)))


def test_joints_that_slide_are_drawn_in_metres_beside_those_that_turn(tmp_path):
    figure = drawn(tmp_path, LIFT)
    axes = {panel.get_ylabel(): panel for panel in figure.axes if panel.get_ylabel()}
    assert axes.keys() == {"deg", "m"}
    for unit, value in (("deg", np.degrees(0.1)), ("m", 0.1)):
        (line,) = axes[unit].get_lines()
        np.testing.assert_allclose(line.get_ydata(), value)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["lift [m]", "swing"]


def test_where_all_joints_slide_there_is_one_axis(tmp_path):
    axes = [panel for panel in drawn(tmp_path, ALONE).axes if panel.get_ylabel()]
    assert [panel.get_ylabel() for panel in axes] == ["m"]
    np.testing.assert_allclose(axes[0].get_lines()[0].get_ydata(), 0.1)


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    path = tmp_path_factory.mktemp("pendulum") / "pendulum.xml"
    path.write_text(PENDULUM)
    return design_experiment(load_subject(str(path)), rate=100.0)


def test_text_names_motions_set_and_what_is_not_told(plan):
    text = plan_text(plan)
    for motion in plan.motions:
        assert motion.name in text
    assert ", ".join(plan.chosen) in text
    assert "encoder_offset / link_com" in text
    assert "Self-collision is not checked" in text
    assert max(len(line) for line in text.splitlines()) < 190


def test_figures_show_every_motion_and_pair(plan):
    figure = motions_figure(plan)
    titles = [panel.get_title(loc="left") for panel in figure.axes]
    assert sum(bool(t) for t in titles) == len(plan.motions)
    table = separation_figure(plan)
    labels = [label.get_text() for label in table.axes[1].get_yticklabels()]
    assert "coulomb_friction\nagainst backlash" in labels
    assert np.all(
        [label.get_text() for label in table.axes[0].get_xticklabels()][:-1]
        == np.array([m.name for m in plan.motions])
    )


def test_report_is_written(plan, tmp_path):
    for path in write_report(plan, tmp_path):
        assert path.stat().st_size > 1000
