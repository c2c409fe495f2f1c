"""The numbers of the paper (arXiv 2606.19699) that results are compared with, and the errors found
in it.

Numbers that describe the robot are in `descriptions/hyperleg.yaml`, those of the motors in
`motors/`.
"""

from __future__ import annotations

from dataclasses import dataclass

LEG_LENGTH = 0.786
"""Hip-pitch axis to ground [m] (Section II.A)."""
HEIGHT = 0.9586
"""Total height [m] (Section II.A)."""
TOTAL_MASS = 32.0
"""Mass of the robot [kg] (Table I)."""
LEG_MASS = 8.27
"""Mass of one leg [kg] (Section II.A)."""

MAX_JOINT_TORQUE = {
    "hip_yaw": 126.0,
    "hip_roll": 126.0,
    "hip_pitch": 126.0,
    "knee": 212.0,
    "ankle_pitch": 111.7,
    "ankle_roll": 48.4,
    "toe": 46.8,
}
"""tau_max^CA [Nm] (Table I)."""

REDUCTION = {
    "hip_yaw": 25.0,
    "hip_roll": 25.0,
    "hip_pitch": 25.0,
    "knee": 31.11,
    "ankle_pitch": 26.0,
    "ankle_roll": 16.51,
    "toe": 31.93,
}
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
class Printed:
    """A number that the paper prints for both of its robots."""

    place: str
    """Table or figure."""
    quantity: str
    unit: str
    toe: float
    """Printed value with the active toe."""
    ablation: float
    """Without it."""
    measure: str
    """Our measure that answers it, of `evaluation.measures`; empty where there is none."""
    caveat: str = ""
    """What the paper leaves open about it."""

    @property
    def change(self) -> float:
        """Relative change from the ablation to the toe [-]."""
        return self.toe / self.ablation - 1


WALK_SPEED, WALK_DISTANCE, TRIALS = 1.33, 20.0, 10
"""Commanded speed [m/s], way [m] and trials of the walk (Section IV.A); trials of the T-test too
(Section IV.B)."""

TABLE_THREE = (
    Printed("Table III", "total power", "W", 260.2, 313.0, "power"),
    Printed("Table III", "Joule heating", "W", 125.9, 167.7, "joule_power"),
    Printed(
        "Table III", "mechanical loss", "W", 134.3, 145.3, "mechanical_power", "signed by Eq. (5)"
    ),
    Printed(
        "Table III",
        "CoT",
        "",
        0.640,
        0.776,
        "cost_of_transport",
        "neither P/(m g v) at 1.33 m/s nor at 20 m over the time",
    ),
    Printed("Table III", "time to goal", "s", 15.96, 16.13, "time"),
    Printed(
        "Table III",
        "average heel-strike GRF",
        "N",
        970.0,
        1021.1,
        "grf_peak",
        "window, filter and contact stiffness are not printed",
    ),
)
"""Walking 20 m at 1.33 m/s, means of ten trials of one training each."""

RIGHT_LEG_POWER = (
    Printed(
        "Section IV.A",
        "hip power, right leg",
        "W",
        103.7,
        126.0,
        "right_hip_absolute_power",
        "signed, positive or absolute is not printed",
    ),
    Printed(
        "Section IV.A",
        "knee power, right leg",
        "W",
        61.8,
        68.9,
        "right_knee_absolute_power",
        "signed, positive or absolute is not printed",
    ),
    Printed(
        "Section IV.A",
        "ankle power, right leg",
        "W",
        47.5,
        61.1,
        "right_ankle_absolute_power",
        "signed, positive or absolute is not printed",
    ),
)
"""Means over the gait cycle (Fig. 6 and the text on it)."""

TABLE_FOUR = (
    Printed("Table IV", "time to goal", "s", 16.06, 16.08, "time"),
    Printed("Table IV", "max speed", "m/s", 3.313, 3.549, "peak_speed"),
    Printed("Table IV", "average speed", "m/s", 2.085, 2.182, "mean_speed"),
    Printed(
        "Table IV",
        "average path deviation",
        "m",
        0.231,
        0.308,
        "mean_deviation",
        "from the course or from the leg being run is not printed",
    ),
    Printed(
        "Table IV",
        "max path deviation",
        "m",
        0.682,
        1.033,
        "peak_deviation",
        "from the course or from the leg being run is not printed",
    ),
)
"""Robot T-test, means of ten trials of one training each."""


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
        "The matrix stands the wrong way round: read as printed, a joint torque of 1 Nm would need "
        "a motor torque of 31 Nm.",
        "joint_torque = M motor_torque with the printed M; motor_velocity = M^T joint_velocity; "
        "the paper's J_m is M^-T.",
    ),
    Inconsistency(
        "Table I, joints, omega_max",
        "300.0, 327.2 and 366.0 rad/s in the joint block are the motors' no-load speeds.",
        "Joint speeds follow from M: the fastest single-joint motion before the first motor "
        "reaches its no-load speed.",
    ),
    Inconsistency(
        "Table I, tau_max^CA",
        "The printed maxima are 1.0 (hip) and 0.9 (below) times the sum of |M| tau_max; the factor "
        "0.9 is not explained.",
        "A derate field for each actuator, 1.0 and 0.9 by default.",
    ),
    Inconsistency(
        "Table I, tau_max^CA",
        "The maxima belong to one joint at a time: the motors below the hip are shared, so they "
        "cannot be reached together.",
        "The exact set of reachable torques, a zonotope, instead of a box.",
    ),
    Inconsistency(
        "Eq. (3) and Table I",
        "Reductions of ankle pitch and toe differ between the walking and the standing posture; "
        "the law between them is not given.",
        "Both postures as presets, and a linkage model calibrated to both, labelled assumed.",
    ),
    Inconsistency(
        "Table I, Cp",
        "Cp of RI70 and RI60 is R/Kt^2 with Kt = 0.1118 and 0.0850 Nm/A, not the vendor's 0.130 "
        "and 0.100, with which it would be 27 % less.",
        "The paper's Cp is a named preset; the catalogue derives Cp from the vendor's R and Kt.",
    ),
    Inconsistency(
        "Table I, driver efficiency",
        "0.9 out and 0.8 back stand in the table but not in Eq. (5), and Table III's rows add up "
        "without them.",
        "Motor-side (the paper's) and battery-side energy are both reported.",
    ),
    Inconsistency(
        "Section IV, ablation",
        "Without the toe's motor the knee falls from 212 to 166 Nm and ankle pitch from 111.7 to "
        "76.3 Nm: "
        "the comparison of toe and no toe is also one of strong and weak knees.",
        "Four variants: active toe, locked toe with its motor, removed at equal mass, removed with "
        "its mass.",
    ),
    Inconsistency(
        "Table III, CoT",
        "0.640 and 0.776 are neither P/(m g v) at v = 1.33 m/s (0.623, 0.750) nor at v = 20 m / "
        "time (0.661, 0.804).",
        "Energy over m g times distance, over the whole run and in steady state.",
    ),
    Inconsistency(
        "Fig. 6",
        "Right-leg joint powers sum to 213 and 256 W, while the whole robot draws 260 and 313 W.",
        "Signed, positive and absolute powers are reported apart, and joint sums are tested to "
        "equal the total.",
    ),
    Inconsistency(
        "Table III, GRF",
        '"Avg GRF" of 970.0 and 1021.1 N is 3.09 and 3.25 body weights, so a mean of peaks; '
        "window, filter and contact stiffness are not given.",
        "Peak within 50 ms of touchdown, filter stated, over a band of contact stiffness; also "
        "loading rate and impulse.",
    ),
    Inconsistency(
        "Table IV and Fig. 7",
        "The size of the T-test is not printed; time times mean speed gives 33.5 and 35.1 m, the "
        "human test is 36.56 m long.",
        "The human test's lengths with an arrival radius of 0.5 m, both in the protocol's file.",
    ),
    Inconsistency(
        "Tables III and IV",
        "One training each, no spread given: 16.06 s against 16.08 s cannot be told apart.",
        "Several seeds and trials, bootstrap intervals, and a verdict that says where nothing can "
        "be told.",
    ),
    Inconsistency(
        "Section I",
        "125 W for a 70 kg adult at 1.33 m/s gives a CoT of 0.137, not 0.316.",
        "Neither is used as a target.",
    ),
)
"""Errors and gaps of the paper."""
