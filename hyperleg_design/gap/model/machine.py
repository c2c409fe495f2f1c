"""The joints and motors of a subject, as the actuation model of the simulation needs them."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.simulation.drives.machine import Machine
from hyperleg_design.simulation.drives.machine import machine_of as machine_of_design
from hyperleg_design.simulation.drives.two_mass import LIGHTEST


def machine_of(subject: Subject) -> Machine:
    """Describe the joints and motors of a subject for the actuation model; unknown gains are 0.

    Args:
        subject: the robot.

    Returns:
        Arrays in the order of the subject's joints and motors.
    """
    gains = np.nan_to_num(subject.gains)
    count = len(subject.motors)
    power, rated, voltage = np.zeros(count), np.full(count, np.inf), subject.voltage
    if subject.design is not None:
        whole = machine_of_design(subject.design)
        places = [whole.motor(name) for name in subject.motors]
        power = whole.power_constant[places]
        rated = whole.rated_torque[places]
        voltage = whole.voltage
    return Machine(
        joints=subject.joints,
        motors=subject.motors,
        joint_from_motor=subject.joint_from_motor,
        motor_from_joint=subject.motor_from_joint,
        stiffness=gains[:, 0],
        damping=gains[:, 1],
        rotor_inertia=subject.rotor_inertia,
        no_load_speed=subject.no_load_speed,
        stall_torque=subject.stall_torque,
        peak_torque=subject.torque_limit,
        power_constant=power,
        rated_torque=rated,
        voltage=voltage,
    )


def rotor(subject: Subject, motor: int) -> float:
    """Look up the inertia of a rotor on its belt.

    Args:
        subject: the robot.
        motor: index of the motor.

    Returns:
        The inertia [kg m^2]; a very light one where the model has none.
    """
    own = float(subject.rotor_inertia[motor])
    return own if own > 0 else LIGHTEST
