"""Models and layouts of the designs of an environment."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.gap.playback.overlay import Overlay
from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.stepping.robots import robots_of
from hyperleg_design.simulation.tasks import load_task


def test_each_design_has_its_own_model_and_layout(design):
    task = load_task("walk")
    designs = [task.posed(design.with_values({"toe.mass": mass})) for mass in (0.2, 0.5)]
    (light, first), (heavy, second) = robots_of(designs, task, ())
    assert heavy.body_mass.sum() - light.body_mass.sum() == pytest.approx(2 * 0.3)
    assert second.weight - first.weight == pytest.approx(2 * 0.3 * GRAVITY)
    np.testing.assert_array_equal(first.default, layout_of(designs[0]).default)


def test_a_payload_weighs_in_the_layout(design):
    """Rewards and falls are judged by the weight of the robot that is simulated."""
    task = load_task("walk")
    own = task.posed(design)
    change = {("payload", "pelvis"): {"mass": 5.0}}
    alterations = Overlay("hyperleg", change, {}).alterations(own)
    ((model, layout),) = robots_of([own], task, alterations)
    assert layout.weight == pytest.approx(layout_of(own).weight + 5.0 * GRAVITY)
    assert layout.weight == pytest.approx(float(model.body_mass.sum()) * GRAVITY)
