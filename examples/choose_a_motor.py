"""Choose a motor for the knee: try the whole catalogue at once, as one batch of designs.

Run: python examples/choose_a_motor.py
"""

import numpy as np

import hyperleg_design as hl

names = np.array(sorted(hl.catalogue()))
batch = hl.load_design("hyperleg").with_values({"actuators.knee.motor": names})

mass = hl.mass_table(batch).total
torque = hl.max_joint_torque(batch)[:, 3]
speed = hl.single_joint_speed(batch)[:, 3]
for i in np.argsort(-torque):
    print(
        f"{names[i]:12} robot {mass[i]:6.2f} kg   knee {torque[i]:6.1f} Nm   {speed[i]:5.1f} rad/s"
    )
