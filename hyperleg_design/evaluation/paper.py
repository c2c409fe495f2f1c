"""The numbers of the paper (arXiv 2606.19699) that results are compared with, and the errors found in it.

Numbers that describe the robot are in `descriptions/hyperleg.yaml`, those of the motors in `motors/`.
"""

from __future__ import annotations

from dataclasses import dataclass

PAPER = "arXiv 2606.19699"

LEG_LENGTH = 0.786
"""Hip-pitch axis to ground [m] (Section II.A)."""
HEIGHT = 0.9586
"""Total height [m] (Section II.A)."""
TOTAL_MASS = 32.0
"""[kg] (Table I)"""
LEG_MASS = 8.27
"""[kg] (Section II.A)"""

MAX_JOINT_TORQUE = {"hip_yaw": 126.0, "hip_roll": 126.0, "hip_pitch": 126.0, "knee": 212.0, "ankle_pitch": 111.7, "ankle_roll": 48.4, "toe": 46.8}
"""tau_max^CA [Nm] (Table I)."""

REDUCTION = {"hip_yaw": 25.0, "hip_roll": 25.0, "hip_pitch": 25.0, "knee": 31.11, "ankle_pitch": 26.0, "ankle_roll": 16.51, "toe": 31.93}
"""Reduction at standing pose [-] (Table I)."""

PRINTED_JOINT_SPEED = {
    "hip_yaw": 300.0,
    "hip_roll": 300.0,
    "hip_pitch": 300.0,
    "knee": 327.2,
    "ankle_pitch": 366.0,
    "ankle_roll": 366.0,
    "toe": 366.0,
}
"""omega_max as the joint block of Table I prints it [rad/s]; these are the motors' speeds."""

WALKING_MATRIX = (
    (25.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (0.0, 25.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (0.0, 0.0, 25.0, 0.0, 0.0, 0.0, 0.0),
    (0.0, 0.0, 0.0, -31.11, -31.11, -31.11, -31.11),
    (0.0, 0.0, 0.0, 0.0, 26.69, 26.69, 19.23),
    (0.0, 0.0, 0.0, 0.0, 16.51, -16.51, 0.0),
    (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 21.27),
)
"""The matrix of Eq. (3), which maps motor torques to joint torques [-]."""


@dataclass(frozen=True)
class Inconsistency:
    """Something in the paper that does not fit together, or is left open."""

    place: str
    """Where in the paper."""
    finding: str
    """What does not fit, with the numbers."""
    choice: str
    """What this project does instead."""


INCONSISTENCIES = (
    Inconsistency(
        "Eq. (3)",
        "The matrix stands the wrong way round: read as printed, a joint torque of 1 Nm would need a motor torque of 31 Nm.",
        "joint_torque = M motor_torque with the printed M; motor_velocity = M^T joint_velocity; the paper's J_m is M^-T.",
    ),
    Inconsistency(
        "Table I, joints, omega_max",
        "300.0, 327.2 and 366.0 rad/s in the joint block are the motors' no-load speeds.",
        "Joint speeds follow from M: the fastest single-joint motion before the first motor reaches its no-load speed.",
    ),
    Inconsistency(
        "Table I, tau_max^CA",
        "The printed maxima are 1.0 (hip) and 0.9 (below) times the sum of |M| tau_max; the factor 0.9 is not explained.",
        "A derate field for each actuator, 1.0 and 0.9 by default.",
    ),
    Inconsistency(
        "Table I, tau_max^CA",
        "The maxima belong to one joint at a time: the motors below the hip are shared, so they cannot be reached together.",
        "The exact set of reachable torques, a zonotope, instead of a box.",
    ),
    Inconsistency(
        "Eq. (3) and Table I",
        "Reductions of ankle pitch and toe differ between the walking and the standing posture; the law between them is not given.",
        "Both postures as presets, and a linkage model calibrated to both, labelled assumed.",
    ),
    Inconsistency(
        "Table I, Cp",
        "Cp of RI70 and RI60 is R/Kt^2 with Kt = 0.1118 and 0.0850 Nm/A, not the vendor's 0.130 and 0.100, with which it would be 27 % less.",
        "The paper's Cp is a named preset; the catalogue derives Cp from the vendor's R and Kt.",
    ),
    Inconsistency(
        "Table I, driver efficiency",
        "0.9 out and 0.8 back stand in the table but not in Eq. (5), and Table III's rows add up without them.",
        "Motor-side (the paper's) and battery-side energy are both reported.",
    ),
    Inconsistency(
        "Section IV, ablation",
        "Without the toe's motor the knee falls from 212 to 166 Nm and ankle pitch from 111.7 to 76.3 Nm: "
        "the comparison of toe and no toe is also one of strong and weak knees.",
        "Four variants: active toe, locked toe with its motor, removed at equal mass, removed with its mass.",
    ),
    Inconsistency(
        "Table III, CoT",
        "0.640 and 0.776 are neither P/(m g v) at v = 1.33 m/s (0.623, 0.750) nor at v = 20 m / time (0.661, 0.804).",
        "Energy over m g times distance, over the whole run and in steady state.",
    ),
    Inconsistency(
        "Fig. 6",
        "Right-leg joint powers sum to 213 and 256 W, while the whole robot draws 260 and 313 W.",
        "Signed, positive and absolute powers are reported apart, and joint sums are tested to equal the total.",
    ),
    Inconsistency(
        "Section I",
        "125 W for a 70 kg adult at 1.33 m/s gives a CoT of 0.137, not 0.316.",
        "Neither is used as a target.",
    ),
)
"""Errors and gaps of the paper that touch the design and its analysis."""
