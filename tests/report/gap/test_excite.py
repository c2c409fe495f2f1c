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
