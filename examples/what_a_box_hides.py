"""Motors below the hip are shared: what the knee can give depends on what the ankle takes.

Run: python examples/what_a_box_hides.py
"""

import numpy as np

import hyperleg_design as hl
from hyperleg_design.sizing import zonotope
from hyperleg_design.sizing.envelope import motor_envelope

design = hl.load_design("hyperleg")
matrix = hl.joint_from_motor(design, "walking")
peak = motor_envelope(design).peak_torque

low, high = zonotope.box(matrix, -peak, peak)
print("largest torque of each joint, whatever the others do [Nm]:", np.round(high, 1))
print(
    "largest with the others at zero                     [Nm]:",
    np.round([zonotope.alone(matrix, -peak, peak, j) for j in range(7)], 1),
)
share = zonotope.zonotope_to_box_volume(matrix[3:, 3:], -peak[3:], peak[3:])
print(f"of the box below the hip, {100 * share:.1f} % can be reached")
