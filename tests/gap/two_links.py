"""An arm of two links with rotors on stiff springs, as textbooks write its dynamics."""

import numpy as np

JOINTS = ("shoulder", "elbow")
MASS, LENGTH, COM, INERTIA = (1.2, 0.8), (0.3, 0.25), (0.15, 0.12), (0.012, 0.006)
ROTOR, STIFF, DAMPING, LOSS = 0.015, 3000.0, 1.5, 0.1
GAINS = {"shoulder": (80.0, 4.0), "elbow": (50.0, 2.5)}
STEP, RATE = 1e-4, 200

MJCF = f"""<mujoco><worldbody><body name="upper" euler="90 0 0">
<joint name="shoulder" type="hinge" axis="0 0 1" armature="{ROTOR}" frictionloss="{LOSS}"/>
<inertial pos="{COM[0]} 0 0" mass="{MASS[0]}" diaginertia="0.012 0.012 {INERTIA[0]}"/>
<body name="fore" pos="{LENGTH[0]} 0 0">
<joint name="elbow" type="hinge" axis="0 0 1" armature="{ROTOR}" frictionloss="{LOSS}"/>
<inertial pos="{COM[1]} 0 0" mass="{MASS[1]}" diaginertia="0.006 0.006 {INERTIA[1]}"/></body></body></worldbody>
<actuator><motor name="shoulder" joint="shoulder" ctrlrange="-40 40"/><motor name="elbow" joint="elbow" ctrlrange="-40 40"/></actuator></mujoco>"""  # noqa: E501


def mass_and_bias(q, v):
    """Of a planar arm in a vertical plane, angles from the horizontal, gravity down (Craig,
    Introduction to Robotics, 6.7).
    """
    c2, s2 = np.cos(q[1]), np.sin(q[1])
    far = MASS[1] * LENGTH[0] * COM[1]
    m22 = INERTIA[1] + MASS[1] * COM[1] ** 2
    m12 = m22 + far * c2
    m11 = INERTIA[0] + MASS[0] * COM[0] ** 2 + MASS[1] * LENGTH[0] ** 2 + m22 + 2 * far * c2
    fore = 9.81 * MASS[1] * COM[1] * np.cos(q[0] + q[1])
    upper = 9.81 * (MASS[0] * COM[0] + MASS[1] * LENGTH[0]) * np.cos(q[0])
    bias = np.array(
        [-far * s2 * v[1] * (2 * v[0] + v[1]) + upper + fore, far * s2 * v[0] ** 2 + fore]
    )
    return np.array([[m11, m12], [m12, m22]]), bias
