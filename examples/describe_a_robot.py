"""Describe a robot: start from the paper's, change it, see what follows, and write files other
tools load.

Run: python examples/describe_a_robot.py
"""

from pathlib import Path

import hyperleg_design as hl

design = hl.load_design("hyperleg", overrides={"toe.mass": 0.30, "actuators.knee.motor": "RI80"})
masses = hl.mass_table(design)
print(
    f"{masses.total:.2f} kg, thigh {masses.thigh:.2f} kg: the heavier knee motor makes a heavier "
    f"thigh"
)

for name, variant in hl.variants(design).items():
    torque = hl.max_joint_torque(variant)
    print(
        f"{name:20} {hl.mass_table(variant).total:6.2f} kg, knee {torque[3]:6.1f} Nm, ankle pitch "
        f"{torque[4]:6.1f} Nm"
    )

folder = hl.build(design, Path("results/examples/robot"))
print("written:", ", ".join(sorted(p.name for p in folder.iterdir() if not p.name.startswith("."))))
