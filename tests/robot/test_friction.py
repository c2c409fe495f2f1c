from __future__ import annotations

import numpy as np

from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.friction import FRICTION_SPEED
from hyperleg_design.simulation.settings import Physics
from hyperleg_design.sizing.demand import joint_friction


def test_sizing_and_simulation_share_the_width() -> None:
    assert Physics().friction_velocity == FRICTION_SPEED
    design = load_design("toe")
    knee = 3
    at_width = joint_friction(design, np.full(7, FRICTION_SPEED))[knee]
    expected = (
        float(design.joints.knee.coulomb) * np.tanh(1.0)
        + float(design.joints.knee.viscous) * FRICTION_SPEED
    )
    np.testing.assert_allclose(at_width, expected)
