"""Logs of a simulation with an effect added, for comparing its alteration with its trace."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.playback.plant import Plant
from hyperleg_design.gap.signals.conditioning import condition

TICK, SUBSTEPS = 0.005, 5


def altered(
    subject,
    alterations,
    target,
    duration=4.0,
    *,
    sees=("motor_torque",),
    temperature=None,
    battery=None,
):
    """Signals of a closed-loop simulation of a fixed subject, with what its sensors tell.

    Args:
        subject: the robot.
        alterations: of its simulation.
        target: from time to targets `(n,)`.
        duration: [s].
        sees: columns of the motors to log.
        temperature: from time to [degC], of all motors.
        battery: from time to [V].
    """
    plant = Plant(subject, alterations, 1, TICK / SUBSTEPS)
    plant.start(
        np.asarray(target(0.0), float)[None], np.zeros((1, len(subject.joints))), None, None
    )
    rows = {
        k: []
        for k in (
            "position",
            "position_target",
            "motor_torque",
            "motor_torque_command",
            "motor_velocity",
        )
    }
    time = np.arange(round(duration / TICK)) * TICK
    for now in time:
        rows["position"].append(plant.measured()[0][0].copy())
        rows["position_target"].append(np.asarray(target(now), float))
        heat = None if temperature is None else np.full((1, len(subject.motors)), temperature(now))
        volts = None if battery is None else np.full(1, battery(now))
        for part in range(SUBSTEPS):
            driven = plant.step(
                "target", np.asarray(target(now + part * TICK / SUBSTEPS), float)[None], heat, volts
            )
            if part == 0:
                rows["motor_torque"].append(driven.believed[0].copy())
                rows["motor_torque_command"].append(driven.command[0].copy())
                rows["motor_velocity"].append(driven.motor_velocity[0].copy())
    kept = ("position", "position_target", *sees)
    names = {"position": subject.joints, "position_target": subject.joints}
    signals = {
        f"{kind}/{name}": np.array(rows[kind])[:, i]
        for kind in kept
        for i, name in enumerate(names.get(kind, subject.motors))
    }
    if temperature is not None:
        signals |= {
            f"motor_temperature/{m}": np.array([temperature(t) for t in time])
            for m in subject.motors
        }
    if battery is not None:
        signals["battery_voltage"] = np.array([battery(t) for t in time])
    gains = {j: tuple(g) for j, g in zip(subject.joints, subject.gains.tolist(), strict=True)}
    return condition(Log("simulated", time, signals, Metadata(base="fixed", gains=gains)), subject)
