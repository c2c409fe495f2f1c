"""Second rig plant, built differently from the first so that what is developed on one can be
checked on the other.

| | first | second |
|---|---|---|
| integrator | semi-implicit Euler, 0.25 ms | drift-kick-drift, 0.2 ms, accelerations at the middle
| | friction | LuGre bristles | gears one to one: Coulomb and Stribeck with exact sticking, at the
rotor; coupled: Dahl, at the joints | | drive | first-order torque loop, clipped by the envelope |
winding with inductance under a voltage limit, back-EMF fed forward | | control | filtered speed of
the joint | differences of an encoder on the rotor | | transmission | linear belt | belt that
stiffens |
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from hyperleg_design.validation.blind.plants.plant import (
    RigPlant,
    Trace,
    columns_of,
    inverse_inertia,
    traces_of,
)
from hyperleg_design.validation.blind.plants.rig import SETTLING

STEP = 0.2e-3
"""Of the integrator [s]."""
CONTROL_STEPS = 5
"""Integrator steps a tick of the drives' controllers: 1 kHz."""
ELECTRICAL = 900.0
"""Resistance over inductance of the windings [1/s]."""
STIFFENING = 0.02
"""Stretch of a belt, over the largest reduction, at which it is twice as stiff [rad]."""
BELT_STIFFNESS, BELT_DAMPING = 2.0, 4.0
"""Over those of the first plant's belts."""
PRESLIDING = 8e-4
"""Angle over which Dahl's friction builds up [rad]."""
DIFFERENCED = 1
"""Control ticks over which the rotor's encoder is differenced."""
_HISTORY = 64


def simulate_other(
    plants: Sequence[RigPlant], targets: np.ndarray, rate: float, *, seeds: Sequence[int]
) -> list[Trace]:
    """Run rigs side by side; arguments and result as `rig.simulate`.

    `position` and `velocity` are the joints' own; `encoder` is what the rotors' encoders say of
    them.

    Args:
        plants: the rigs.
        targets: `(b, ticks, n)` [rad].
        rate: of the targets [Hz].
        seeds: of the noise, one a rig.

    Returns:
        One trace a rig.
    """
    import pinocchio as pin

    b, ticks, n = targets.shape
    m = plants[0].rotor_inertia.size
    coupled = n != m or bool(np.any(plants[0].declared - np.diag(np.diag(plants[0].declared))))

    def of(name: str) -> Any:
        return np.stack([np.asarray(getattr(p, name), float) for p in plants])

    h, control = STEP, STEP * CONTROL_STEPS
    hold, lead = round(1.0 / (rate * control)), round(SETTLING / control)
    count = ticks * hold
    matrix, declared = of("joint_from_motor"), of("declared")
    transposed = np.ascontiguousarray(np.swapaxes(matrix, 1, 2))
    allot = np.ascontiguousarray(np.stack([np.linalg.pinv(p.declared).T for p in plants]))
    inertia = of("rotor_inertia")
    stiff = BELT_STIFFNESS * of("belt_stiffness")
    damp = BELT_DAMPING * of("belt_damping")
    play = of("backlash") / 2
    soft_limit = STIFFENING * np.abs(matrix).max(1)
    mobility = np.stack(
        [
            1 / i + np.einsum("im,ij,jm->m", k, inverse_inertia(p), k)
            for p, k, i in zip(plants, matrix, inertia, strict=True)
        ]
    )
    # Belts too stiff for the step get the stiffest that it carries: they stay rigid to the eye of a
    # log.
    stiff = np.minimum(stiff, (0.45 / h) ** 2 / mobility)
    damp = np.minimum(damp, 0.25 / (h * mobility))
    coulomb = of("coulomb")
    static = of("static")
    stribeck = of("stribeck_speed")
    viscous = of("viscous")
    load = of("load_friction")
    if not coupled:  # gear friction acts before the gear
        gear = np.abs(np.diagonal(matrix, axis1=1, axis2=2))
        for values in (coulomb, static, viscous):
            values[:, :m] += values[:, m:] / (gear if values is not viscous else gear**2)
            values[:, m:] = 0
        load_at = load[:, :m] + load[:, m:]
        stribeck[:, :m] = np.where(load[:, m:] > 0, stribeck[:, :m], stribeck[:, m:] * gear)
        load = np.concatenate([load_at, np.zeros((b, n))], -1)
    at_joints = bool(
        coulomb[:, m:].any()
        or static[:, m:].any()
        or viscous[:, m:].any()
        or load[:, m:].any()
        or of("patch").any()
    )
    spring, spring_rest, rest = of("spring"), of("spring_rest"), of("rest")
    cogging = of("cogging")
    order = of("cogging_order")
    phase = of("cogging_phase")
    ripple = of("ripple")
    scale = of("torque_scale")
    derating = of("derating")
    peak = of("peak_torque")
    stall = of("stall_torque")
    droop = stall / of("no_load_speed")
    nominal = of("voltage")[:, None]
    supply = of("supply")[:, None]
    resistance = of("supply_resistance")[:, None]
    heat = of("power_constant")
    thermal_resistance = of("thermal_resistance")
    thermal_time = of("thermal_time")
    temperature = of("start_temperature")
    late = of("delay") / control
    whole = np.floor(late).astype(int)
    part = late - whole
    follow = 1.0 / np.maximum(of("lag"), 2 * h)
    kp, kd = of("stiffness"), of("damping")
    offset, drift, eccentricity = of("offset"), of("drift"), of("eccentricity")
    ratio = np.abs(declared).max(1)
    counts = of("resolution").min(-1, keepdims=True) * ratio / np.where(ratio > 1, 12, 2)
    patch, patch_middle, hysteresis = of("patch"), of("patch_middle"), of("hysteresis")
    push = of("push")
    beat = of("push_frequency")[:, None]
    hardening = of("hardening")
    coupling = of("coupling")
    drag = of("drag")
    from_rotor = np.ascontiguousarray(np.linalg.pinv(declared))  # (b, m, n): q^T = theta^T pinv(M)
    loss = of("loss")
    dice = [np.random.default_rng([seed, 1]) for seed in seeds]
    silent = np.zeros(b, int)
    models, datas = [p.model for p in plants], [p.model.createData() for p in plants]

    q, qd = targets[:, 0] - offset, np.zeros((b, n))
    rotor = (q[:, None] @ matrix)[:, 0]
    spin = np.zeros((b, m))
    torque = np.zeros((b, m))
    wanted = np.zeros((b, m))
    given = np.zeros((b, m))
    held, memory = np.zeros((b, n)), np.zeros((b, n))
    history, angles = np.zeros((_HISTORY, b, m)), None
    seen = np.zeros((DIFFERENCED + 1, b, n))
    lines, columns = np.arange(b)[:, None], np.arange(m)[None]
    bus = np.broadcast_to(supply, (b, 1)).copy()
    recorded = {name: np.empty((count, b, width)) for name, width in columns_of(n, m).items()}
    joint_pull = np.zeros((b, n))
    for tick in range(-lead, count):
        row, within = divmod(max(tick, 0), hold)
        target = targets[:, row] + (targets[:, min(row + 1, ticks - 1)] - targets[:, row]) * (
            within / hold
        )
        angles = (np.round(rotor / counts) * counts)[:, None]
        reading = (angles @ from_rotor)[:, 0]
        shown = (
            reading + offset + eccentricity * np.sin(3 * reading) + drift * max(tick * control, 0.0)
        )
        if tick == -lead:
            seen[:] = shown
        place = tick % (DIFFERENCED + 1)
        speed = (shown - seen[(tick + 1) % (DIFFERENCED + 1)]) / (DIFFERENCED * control)
        seen[place] = shown
        fresh = ((kp * (target - shown) - kd * speed)[:, None] @ allot)[:, 0]
        slot = tick % _HISTORY
        for i in np.flatnonzero(loss):
            if silent[i] == 0 and dice[i].random() < loss[i] * control / (0.04 * (1 - loss[i])):
                silent[i] = 1 + int(dice[i].exponential(0.04) / control)
        history[slot] = np.where(silent[:, None] > 0, history[slot - 1], fresh)
        np.maximum(silent - 1, 0, out=silent)
        index = (slot - whole) % _HISTORY
        wanted = np.clip(
            (1 - part) * history[index, lines, columns] + part * history[index - 1, lines, columns],
            -peak,
            peak,
        )
        bus = (
            supply
            - resistance
            * np.maximum((given * spin + heat * given**2).sum(1, keepdims=True), 0.0)
            / supply
        )
        ceiling = stall * bus / nominal
        temperature += (
            control / thermal_time * (thermal_resistance * heat * given**2 - (temperature - 25.0))
        )
        strength = scale * (1.0 - derating * np.maximum(temperature - 25.0, 0.0))
        if tick >= 0:
            for name, values in (
                ("position", q),
                ("velocity", qd),
                ("encoder", shown),
                ("speed", speed),
                ("motor_velocity", spin),
                ("command", fresh),
                ("drive_torque", torque),
                ("pull", joint_pull),
                ("temperature", temperature),
                ("voltage", bus),
            ):
                recorded[name][tick] = values
        for _ in range(CONTROL_STEPS):
            back_emf = droop * spin
            terminal = np.clip(
                wanted + back_emf + follow / ELECTRICAL * (wanted - torque), -ceiling, ceiling
            )
            torque = torque + (terminal - back_emf - torque) * min(ELECTRICAL * h, 0.9)
            given = strength * torque
            # Drift, kick at the middle, drift.
            q = q + 0.5 * h * qd
            rotor = rotor + 0.5 * h * spin
            stretch = rotor - (q[:, None] @ matrix)[:, 0]
            taut = stretch - np.clip(stretch, -play, play)
            pull = stiff * taut * (1 + np.minimum((taut / soft_limit) ** 2, 3.0)) + damp * (
                spin - (qd[:, None] @ matrix)[:, 0]
            ) * (taut != 0)
            joint_pull = (pull[:, None] @ transposed)[:, 0]
            force = joint_pull
            if at_joints:
                capacity = (
                    coulomb[:, m:]
                    + (static - coulomb)[:, m:] * np.exp(-np.abs(qd / stribeck[:, m:]))
                    + load[:, m:] * np.abs(joint_pull)
                )
                capacity = capacity + patch * (np.abs(q - patch_middle) < 0.15) + 1e-12
                bound = capacity * np.sign(qd)
                held = bound + (held - bound) * np.exp(-np.abs(qd) * (h / PRESLIDING))
                force = force - held - viscous[:, m:] * qd
            bent = q - rest
            memory = (memory + 4.0 * h * qd) / (1.0 + 4.0 * h * np.abs(qd))
            thrust = push * (np.maximum(np.sin(2 * np.pi * beat * (tick * control)), 0.0) ** 6)
            force = (
                force
                + thrust
                - spring * (q - spring_rest)
                - hysteresis * memory
                - hardening * bent**3
                - (coupling @ bent[:, :, None])[:, :, 0]
                - drag * qd * np.abs(qd)
            )
            qd = qd + h * np.stack(
                [
                    pin.aba(model, data, q[i], qd[i], force[i])
                    for i, (model, data) in enumerate(zip(models, datas, strict=True))
                ]
            )
            drive = (
                given
                + cogging * np.sin(order * rotor + phase)
                + ripple * given * (np.sin(5 * rotor + 0.4) + 0.6 * np.sin(7 * rotor + 1.9))
            )
            free = spin + h * (drive - pull - viscous[:, :m] * spin) / inertia
            capacity = (
                coulomb[:, :m]
                + (static - coulomb)[:, :m] * np.exp(-((spin / stribeck[:, :m]) ** 2))
                + load[:, :m] * np.abs(pull)
            )
            spin = np.sign(free) * np.maximum(np.abs(free) - h * capacity / inertia, 0.0)
            q = q + 0.5 * h * qd
            rotor = rotor + 0.5 * h * spin
    return traces_of(recorded, np.full((count, b), np.nan), control)
