"""Helping forces on the pelvis at the start of training, to be taken away before it ends; never the
paper's, never in a test.

Without them no reward tried so far taught this biped its first steps. They act in an environment
only while one is given its `Assist`, which none is by default.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.simulation.state import Motion

FORCE = 120.0
"""Horizontal force over the error of the velocity [N s/m]; assumed. Twice as much throws a
standing robot over before its legs can follow."""
TORQUE = 400.0
"""Uprighting torque over tilt [Nm/rad]; assumed."""
DAMPING = 40.0
"""Torque over the pelvis's rate of turning [Nms/rad]; assumed."""
DECAY = 0.93
"""Factor on the gain at each decay; assumed."""
OFF_BELOW = 0.01
"""Gain below which it is zero; assumed."""


@dataclass
class Assist:
    """A force toward the commanded velocity and an uprighting torque, scaled by a gain that only
    decays.

    Robots get from none of it to all of it, evenly: with the same gain for all, walking is learnt
    with the assist, and all fall when its last fifth goes.
    """

    gain: float = 1.0
    """1 full, 0 gone [-]."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.gain <= 1.0:
            raise InputError("assist", "gain", self.gain, "expects a number within 0 .. 1")

    @property
    def active(self) -> bool:
        """Whether the assist still exerts forces."""
        return self.gain > 0.0

    def decay(self) -> None:
        """Less by the factor `DECAY`; zero once below `OFF_BELOW`."""
        self.gain *= DECAY
        if self.gain < OFF_BELOW:
            self.gain = 0.0

    def wrench(self, motion: Motion, speed: np.ndarray, turns: bool) -> np.ndarray:
        """Compute the helping force and torque on the pelvis.

        Args:
            motion: of the robots.
            speed: wanted straight ahead [m/s], `(n,)`.
            turns: whether the robots have to turn, so that their yaw is left to them.

        Returns:
            Force [N] and torque [Nm] in the world, `(n, 6)`.
        """
        ahead = motion.heading
        error = speed - np.einsum("ni,ni->n", ahead, motion.velocity[:, :2])
        up = motion.rotation[:, :, 2]
        turning = np.einsum("nij,nj->ni", motion.rotation, motion.angular_velocity)
        aside = np.stack([-ahead[:, 1], ahead[:, 0]], 1)
        drift = np.einsum("ni,ni->n", aside, motion.velocity[:, :2])
        wrench = np.zeros((len(error), 6))
        wrench[:, :2] = FORCE * (error[:, None] * ahead - drift[:, None] * aside)
        wrench[:, 3] = TORQUE * up[:, 1] - DAMPING * turning[:, 0]
        wrench[:, 4] = -TORQUE * up[:, 0] - DAMPING * turning[:, 1]
        if not turns:
            wrench[:, 5] = -DAMPING * turning[:, 2]
        share = np.linspace(0.0, 1.0, len(error)) if len(error) > 1 else np.ones(1)
        return self.gain * share[:, None] * wrench
