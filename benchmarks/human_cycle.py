"""Fit the human gait cycle to the legs of this robot, and print the knots of `human_gait`.

A robot with shorter feet and other leg lengths than a person cannot walk with a person's joint
angles: its feet would float or slip. This finds the nearest periodic curves of hip, knee and ankle
pitch with which the standing foot moves back at the speed of the pelvis, both feet are on the floor
in double support, and the swinging foot clears it. Least squares over twelve knots a joint.

    python benchmarks/human_cycle.py
"""

from __future__ import annotations

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

from hyperleg_design.robot.load import load_design
from hyperleg_design.robot.mjcf import mujoco_model
from hyperleg_design.simulation import human_gait

HUMAN = {
    "hip_pitch": ((0, -27), (10, -24), (30, -6), (50, 11), (62, 2), (75, -22), (87, -31)),
    "knee": ((0, 7), (13, 17), (38, 6), (52, 14), (62, 38), (73, 60), (85, 35), (95, 6)),
    "ankle_pitch": ((0, 0), (7, 5), (30, -6), (45, -10), (55, 2), (63, 15), (75, 0), (87, -1)),
}
"""Share of the cycle [%] and angle [deg] of adult level walking, rounded (after Perry and
Burnfield, Gait Analysis, 2nd edition, 2010); signs as in `human_gait.KNOTS`."""
SHARES = np.arange(100)
KNOTS = np.arange(12) * 100 / 12
TOE_OFF, FLAT, HEEL_OFF = 62, 8, 40
"""End of the stance, of the heel's rocker and of the flat foot [% of the cycle]."""
CLEARANCE = 0.02
"""Of the swinging foot above the floor in mid-swing [m]; assumed."""


def _periodic(at: np.ndarray, values: np.ndarray) -> CubicSpline:
    return CubicSpline(np.append(at, 100.0), np.append(values, values[0]), bc_type="periodic")


def leg() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, float]:
    """Vectors in the sagittal plane with straight legs: hip to knee, knee to ankle, ankle to the
    rearmost pad and to the foremost pad of the foot (not of the toe) [m]; radius of the pads [m].
    """
    model = mujoco_model(load_design("toe"))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    hip, knee, ankle = (
        data.joint(f"left_{name}").xanchor[[0, 2]] for name in ("hip_pitch", "knee", "ankle_pitch")
    )
    pads = [model.geom(f"left_foot_pad_{pad}") for pad in range(4)]
    places = np.array([data.geom(pad.id).xpos[[0, 2]] for pad in pads]) - ankle
    order = places[:, 0].argsort()
    return knee - hip, ankle - knee, places[order[0]], places[order[-1]], float(pads[0].size[0])


def _turned(angle: np.ndarray, vector: np.ndarray) -> np.ndarray:
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([cosine * vector[0] + sine * vector[1], cosine * vector[1] - sine * vector[0]])


THIGH, SHANK, HEEL, BALL, RADIUS = leg()
HUMAN_ANGLES = np.array([_periodic(*np.array(knots, float).T)(SHARES) for knots in HUMAN.values()])


def angles(knots: np.ndarray) -> np.ndarray:
    """Hip, knee and ankle pitch over the cycle [deg], `(3, 100)`, of knots `(36,)`."""
    return np.array([_periodic(KNOTS, values)(SHARES) for values in knots.reshape(3, 12)])


def residuals(knots: np.ndarray) -> np.ndarray:
    """Of slip, height, clearance, human angles and smoothness, each over its tolerance."""
    degrees = angles(knots)
    hip, knee, ankle = np.deg2rad(degrees)
    foot = hip + knee + ankle
    at_ankle = _turned(hip, THIGH) + _turned(hip + knee, SHANK)
    heel, ball = at_ankle + _turned(foot, HEEL), at_ankle + _turned(foot, BALL)
    low = np.minimum(heel[1], ball[1]) - RADIUS
    step = human_gait.SPEED * human_gait.PERIOD / 100
    double = np.arange(TOE_OFF - 50 + 1)
    swing = np.arange(TOE_OFF + 3, 98)
    lift = np.minimum(1.0, np.minimum(swing - TOE_OFF, 100 - swing) / 8)
    return np.concatenate(
        [
            2.0 * (np.diff(heel[0, : HEEL_OFF + 1]) / step + 1),
            2.0 * (np.diff(ball[0, FLAT : TOE_OFF + 1]) / step + 1),
            1.5 * (low[double] - low[double + 50]) / 0.005,
            (heel[1] - ball[1])[FLAT : HEEL_OFF + 1] / 0.005,
            0.3 * (low[:51] - low[:51].mean()) / 0.03,
            np.minimum(low[swing] - low[(swing + 50) % 100] - CLEARANCE * lift, 0) / 0.003,
            [max(np.rad2deg(foot[0]) + 8, 0) / 2],
            np.maximum(degrees[1, :3] - 8, 0),
            np.maximum(degrees[1, 10:HEEL_OFF] - 16, 0),
            np.maximum(2 - degrees[1], 0),
            [max(60 - degrees[1].max(), 0)],
            np.maximum(-11 - degrees[2], 0),
            0.02 * (degrees - HUMAN_ANGLES).ravel(),
            0.25 * np.diff(np.hstack([degrees, degrees[:, :2]]), 2).ravel(),
        ]
    )


def main() -> None:
    """Print knots [deg] and how far the fitted cycle is from the human one."""
    start = np.concatenate([_periodic(*np.array(k, float).T)(KNOTS) for k in HUMAN.values()])
    fitted = least_squares(residuals, start, max_nfev=200).x
    for name, knots, fit, human in zip(
        HUMAN, fitted.reshape(3, 12), angles(fitted), HUMAN_ANGLES, strict=True
    ):
        away = np.sqrt(np.mean((fit - human) ** 2))
        print(f"{name}: {np.round(knots, 1).tolist()}  {away:.1f} deg from human (RMS)")


if __name__ == "__main__":
    main()
