"""What effects of blind plants need besides a size, shared by tests."""

from __future__ import annotations

SHAPES = {
    "stribeck_friction": {"speed": 0.2},
    "controller_gain": {"stiffness": 1.0, "damping": 0.5},
    "cogging": {"order": 7.0, "phase": 0.3},
    "joint_spring": {"rest": 0.1},
    "friction_patch": {"shift": 0.2},
    "periodic_push": {"frequency": 2.0},
    "cross_coupling": {"other": 0.0},
    "tilted_gravity": {"heading": 0.4},
    "payload": {"x": 0.0, "y": 0.0, "z": 0.1},
    "link_com": {"x": 1.0, "y": 0.0, "z": 0.0},
}
