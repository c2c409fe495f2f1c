"""Names and order of joints and motors of one leg (paper, Section II.B)."""

JOINTS = ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_pitch", "ankle_roll", "toe")
"""Joints of a leg, from the pelvis down."""

MOTORS = ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_left", "ankle_right", "toe")
"""Motors of a leg; the two ankle motors drive pitch together and roll against each other."""

ACTUATOR_OF_MOTOR = ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle", "ankle", "toe")
"""Actuator section of the design that each motor of `MOTORS` is built as."""

SIDES = ("left", "right")

SEGMENTS = ("pelvis", "thigh", "shank", "foot", "toe")
"""Segments whose masses the paper prints; one pelvis, the others once a leg."""

VARIANTS = ("toe", "toe_locked", "toe_removed_matched", "toe_removed")
"""Ablations of the active toe, from nothing taken away to everything."""

PASSIVE = "toe_passive"
"""The toe on a spring and a damper in place of its motor, at equal mass."""
LAYOUTS = (*VARIANTS, PASSIVE)
"""All toe layouts that can be made of a robot with an active toe."""
POSTURES = ("walking", "standing")
"""Postures for which the paper prints reductions."""
