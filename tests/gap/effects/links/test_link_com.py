"""A moved centre of mass."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.links.inertial import AddedInertia
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.simulation.alteration import edited


@pytest.fixture(scope="module")
def arm(robot_files, runs):
    log = runs["arm"]
    return condition(log, load_subject(robot_files["arm"], [log]))


def test_a_link_moved_keeps_its_mass_and_shape(arm):
    added = effect("link_com").alteration("forearm", np.array([0.01, 0.0, -0.02]), arm.subject)
    assert isinstance(added, AddedInertia)
    model, changed = arm.subject.model, edited(arm.subject.model, (added,))
    body = model.body("forearm").id
    assert changed.body_mass[body] == pytest.approx(model.body_mass[body])
    np.testing.assert_allclose(
        changed.body_ipos[body] - model.body_ipos[body], [0.01, 0.0, -0.02], atol=1e-12
    )
    np.testing.assert_allclose(
        np.sort(changed.body_inertia[body]), np.sort(model.body_inertia[body]), rtol=1e-9
    )
