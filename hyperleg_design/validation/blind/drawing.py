"""Drawing what is wrong with a robot: its place and the shape of its effect."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hyperleg_design.validation.blind.robots.chain import Chain
from hyperleg_design.validation.blind.truth import KIND
from hyperleg_design.validation.blind.wrong import Wrong

SIGNED = (
    "torque_constant",
    "transmission_ratio",
    "encoder_offset",
    "controller_gain",
    "link_mass",
    "sensor_drift",
    "cross_coupling",
)
"""Effects whose size may be negative."""


def draw(robot: Chain, effect: str, rng: np.random.Generator, taken: Sequence[str] = ()) -> Wrong:
    """An effect at a drawn place with drawn shape; its size is only a sign yet.

    Args:
        robot: the robot.
        effect: its identifier.
        rng: source of randomness.
        taken: places that are not free.

    Returns:
        What is wrong.
    """
    kind = KIND[effect]
    motors = robot.joints if robot.diagonal else robot.motors
    names: Sequence[str] = {
        "joint": robot.joints,
        "motor": motors,
        "link": tuple(link.name for link in robot.links),
        "robot": ("robot",),
        "battery": ("battery",),
    }[kind]
    free = [n for n in names if n not in taken] or list(names)
    if effect == "payload":
        tips = set(range(len(robot.links))) - {link.parent for link in robot.links}
        free = [robot.links[i].name for i in sorted(tips)]
    location = str(rng.choice(free))
    shape: dict[str, float] = {}
    if effect == "payload":
        link = next(link for link in robot.links if link.name == location)
        place = 1.5 * link.com + rng.normal(0, 0.01, 3)
        shape = dict(zip("xyz", place.tolist(), strict=True))
    elif effect == "link_com":
        way = rng.standard_normal(3)
        shape = dict(zip("xyz", (way / np.linalg.norm(way)).tolist(), strict=True))
    elif effect == "stribeck_friction":
        shape = {"speed": float(rng.uniform(0.05, 0.25))}
    elif effect == "controller_gain":
        shape = [
            {"stiffness": 1.0, "damping": 0.0},
            {"stiffness": 0.0, "damping": 1.0},
            {"stiffness": 1.0, "damping": 1.0},
        ][int(rng.integers(3))]
    elif effect == "cogging":
        matrix = np.abs(robot.joint_from_motor)
        column = list(motors).index(location)
        # Periods a turn of the rotor behind gears; of a servo's output, teeth.
        order = (
            float(rng.integers(6, 30))
            if matrix[:, column].max() == 1
            else float(rng.integers(1, 4))
        )
        shape = {"order": order, "phase": float(rng.uniform(-np.pi, np.pi))}
    elif effect == "joint_spring":
        at = list(robot.joints).index(location)
        shape = {"rest": float(robot.rest[at] + rng.uniform(-0.2, 0.2))}
    elif effect == "tilted_gravity":
        shape = {"heading": float(rng.uniform(-np.pi, np.pi))}
    elif effect == "periodic_push":
        shape = {"frequency": float(rng.uniform(0.4, 1.5))}
    elif effect == "friction_patch":
        shape = {"shift": float(rng.uniform(-0.1, 0.1))}
    elif effect == "cross_coupling":
        others = [i for i, name in enumerate(robot.joints) if name != location] or [0]
        shape = {"other": float(rng.choice(others))}
    sign = float(rng.choice([-1.0, 1.0])) if effect in SIGNED else 1.0
    return Wrong(effect, location, sign, shape)
