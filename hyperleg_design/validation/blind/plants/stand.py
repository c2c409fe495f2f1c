"""Motions of a robot on both feet: squats, sways, twists and rocking, with an ankle strategy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ANKLE_STRATEGY = (9.0, 2.6)
"""Change of the ankles' targets over the way [rad/m] and the speed [rad s/m] of the centre of
mass."""
AHEAD = 0.04
"""Where the residual controller holds the centre of mass, before the ankles [m]."""


@dataclass(frozen=True, eq=False)
class Stand:
    """Motions on both feet: amplitudes and frequencies of squat, sway, twist and rock."""

    squat: float
    """Change of the knees [rad]."""
    sway: float
    """Of the hips' and ankles' roll [rad]."""
    twist: float
    """Of the hips' yaw [rad]."""
    rock: float
    """Of the centre of mass, forwards [m]."""
    frequency: np.ndarray
    """Of the five, spread and toes last `(5,)` [Hz]."""
    spread: float = 0.0
    """Of the hips' roll, legs apart: what the ground's friction holds [rad]."""
    turn: float = 0.0
    """Of the hips' yaw, toes apart: as the spread [rad]."""
    knee: float = 0.75
    """Middle of the knees [rad]."""
    lean: float = 0.05
    """Legs' inclination that brings the weight over the middle of the feet [rad]."""

    def targets(
        self,
        time: float,
        ahead: float,
        speed: float,
        roll: float,
        roll_rate: float,
        sides: np.ndarray,
    ) -> np.ndarray:
        """Position targets `(14,)` [rad], left leg first, hip yaw .. toe.

        Args:
            time: [s].
            ahead: centre of mass before the ankles' middle [m].
            speed: of the centre of mass, forwards [m/s].
            roll: of the pelvis [rad].
            roll_rate: [rad/s].
            sides: signs of each leg's hip yaw, hip roll and ankle roll `(2, 3)`.
        """
        grow = min(max(time, 0.0) / 1.0, 1.0)
        wave = grow * np.sin(2 * np.pi * self.frequency * max(time, 0.0))
        knee = self.knee + self.squat * wave[0]
        # Thigh 0.37 m and shank 0.345 m: the hip stays above the ankle.
        hip = np.arctan2(0.345 * np.sin(knee), 0.37 + 0.345 * np.cos(knee))
        ankle = (
            hip
            - knee
            - self.lean
            + ANKLE_STRATEGY[0] * (ahead - AHEAD - self.rock * wave[3])
            + ANKLE_STRATEGY[1] * speed
        )
        sway = self.sway * wave[1]
        legs = []
        for side, out in zip(sides, (1.0, -1.0), strict=True):
            yaw = self.twist * wave[2] + self.turn * out * wave[4]
            apart = self.spread * out * wave[4]
            level = -side[2] * (sway - 0.5 * roll - 0.04 * roll_rate)
            legs.append(
                [side[0] * yaw, side[1] * (sway + apart), -hip + self.lean, knee, ankle, level, 0.0]
            )
        return np.concatenate(legs)
