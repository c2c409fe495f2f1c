"""First rig plant: rotors and joints as two masses on belts, LuGre friction, torque drives;
Pinocchio's ABA, semi-implicit Euler at 0.25 ms.

Coordinates of a robot are its `m` motors, then its `n` joints, `c` in all. With `C = [I; -M]` the
belts stretch by `C^T x`; each pulls `C (stiffness stretch + damping rate)` on the coordinates.
Rotors follow `J w' = drive - friction - pull`, the joints ABA with pull less friction. Several logs
run side by side; only the rigid bodies are taken one by one.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hyperleg_design.validation.blind.plants.plant import (
    RigPlant,
    Trace,
    columns_of,
    inverse_inertia,
    traces_of,
)

STEP = 0.25e-3
"""Of the integrator [s]."""
CONTROL_STEPS = 4
"""Integrator steps a tick of the drives' controllers: 1 kHz."""
SETTLING = 0.6
"""Time that the first target is held before the recording begins [s]."""
BRISTLE_DAMPING = 3e-4
"""Damping over stiffness of the friction's bristles [s]."""
_HISTORY = 128
"""Commands kept for the delay line, 1 ms each."""


def simulate(
    plants: Sequence[RigPlant],
    targets: np.ndarray,
    rate: float,
    *,
    seeds: Sequence[int],
    energy: bool = False,
) -> list[Trace]:
    """Run rigs side by side.

    Args:
        plants: `b` rigs of the same robot.
        targets: position targets `(b, ticks, n)` [rad] at the host's rate; the drives interpolate
            between its ticks.
        rate: of the host [Hz]; divides 1 kHz.
        seeds: of what is random inside the plant (lost packets), one a rig.
        energy: also compute the energy, for checks.
    """
    import pinocchio as pin

    b, ticks, n = targets.shape
    m = plants[0].rotor_inertia.size

    def stack(name: str) -> np.ndarray:
        return np.stack([np.asarray(getattr(p, name), float) for p in plants])

    hold = round(1.0 / (rate * STEP * CONTROL_STEPS))
    lead = round(SETTLING / (STEP * CONTROL_STEPS))
    count = ticks * hold
    h, control = STEP, STEP * CONTROL_STEPS
    matrix = stack("joint_from_motor")
    split = np.concatenate([np.broadcast_to(np.eye(m), (b, m, m)), -matrix], axis=1)
    back = np.ascontiguousarray(np.swapaxes(split, 1, 2))
    split = np.ascontiguousarray(split)
    from_joint = np.stack([np.linalg.pinv(p.declared) for p in plants])
    to_motor = np.ascontiguousarray(np.swapaxes(from_joint, 1, 2))

    stiff, damp, play = stack("belt_stiffness"), stack("belt_damping"), stack("backlash") / 2
    coulomb, static, stribeck = stack("coulomb"), stack("static"), stack("stribeck_speed")
    viscous, bristle, load = stack("viscous"), stack("bristle"), stack("load_friction")
    size = np.maximum(np.maximum(coulomb, static), 1e-9)
    excess, slide, gain = static - coulomb, h * size / bristle, h / bristle
    inverse_rotor = 1.0 / stack("rotor_inertia")
    ahead, soften = _stiff_belts(plants, stiff, damp, inverse_rotor, matrix)
    spring, spring_rest = stack("spring"), stack("spring_rest")
    cogging, order, phase = stack("cogging"), stack("cogging_order"), stack("cogging_phase")
    scale, derating = stack("torque_scale"), stack("derating")
    peak, stall, fastest = stack("peak_torque"), stack("stall_torque"), stack("no_load_speed")
    nominal = stack("voltage")[:, None]
    supply = stack("supply")[:, None]
    resistance = stack("supply_resistance")[:, None]
    heat = stack("power_constant")
    thermal_resistance = stack("thermal_resistance")
    thermal_time = stack("thermal_time")
    temperature = stack("start_temperature")
    delay = stack("delay") / control
    whole = np.floor(delay).astype(int)
    part = delay - whole
    lag = -np.expm1(-h / np.maximum(stack("lag"), 1e-6))
    kp, kd = stack("stiffness"), stack("damping")
    offset, resolution, drift = stack("offset"), stack("resolution"), stack("drift")
    smooth = -np.expm1(-2 * np.pi * stack("velocity_bandwidth")[:, None] * control)
    ripple = stack("ripple")
    patch = stack("patch")
    patch_middle = stack("patch_middle")
    hysteresis = stack("hysteresis")
    push = stack("push")
    beat = stack("push_frequency")[:, None]
    hardening = stack("hardening")
    coupling = stack("coupling")
    drag, eccentricity, rest = stack("drag"), stack("eccentricity"), stack("rest")
    lost = _lost(stack("loss"), lead + count, control, seeds)

    drag_rate = damp + stiff * ahead
    has_play, has_load, has_patch = bool(play.any()), bool(load.any()), bool(patch.any())
    has_extra = any(a.any() for a in (spring, hysteresis, push, hardening, coupling, drag))
    has_motor_extra = any(a.any() for a in (cogging, ripple))
    models, datas = [p.model for p in plants], [p.model.createData() for p in plants]
    aba = pin.aba
    lines, columns = np.arange(b)[:, None], np.arange(m)[None, :]

    state = np.zeros((2, b, 1, m + n))
    x, v = state[0, :, 0], state[1, :, 0]
    x[:, m:] = targets[:, 0] - offset
    x[:, :m] = (x[:, None, m:] @ matrix)[:, 0]
    bristles, memory = np.zeros((b, m + n)), np.zeros((b, n))
    current, wanted = np.zeros((b, m)), np.zeros((b, m))
    history = np.zeros((_HISTORY, b, m))
    speed = np.zeros((b, n))
    bus = np.broadcast_to(supply, (b, 1)).copy()
    force = np.empty((b, m + n))
    rates = np.empty((b, m + n))
    given = np.zeros((b, m))
    droop = stall / fastest

    recorded = {name: np.empty((count, b, width)) for name, width in columns_of(n, m).items()}
    energies = np.full((count, b), np.nan)
    for tick in range(-lead, count):
        row, within = divmod(max(tick, 0), hold)
        target = targets[:, row] + (targets[:, min(row + 1, ticks - 1)] - targets[:, row]) * (
            within / hold
        )
        angle = x[:, m:]
        encoder = angle + offset
        if tick > 0 and drift.any():
            encoder = encoder + drift * (tick * control)
        if eccentricity.any():
            encoder = encoder + eccentricity * np.sin(3 * angle)
        encoder = np.round(encoder / resolution) * resolution
        speed += smooth * (v[:, m:] - speed)
        joint = kp * (target - encoder) - kd * speed
        fresh = (joint[:, None] @ to_motor)[:, 0]
        place = tick % _HISTORY
        history[place] = np.where(lost[:, tick + lead, None], history[place - 1], fresh)
        late = (place - whole) % _HISTORY
        wanted = (1 - part) * history[late, lines, columns] + part * history[
            late - 1, lines, columns
        ]
        # The drives' limits: current, and the voltage that is there against the rotor's back-EMF.
        available = stall * (bus / nominal)
        back_emf = droop * v[:, :m]
        wanted = np.clip(np.clip(wanted, -available - back_emf, available - back_emf), -peak, peak)
        power = np.maximum((given * v[:, :m] + heat * given * given).sum(1, keepdims=True), 0.0)
        bus = supply - resistance * power / supply
        temperature += (
            control
            / thermal_time
            * (thermal_resistance * heat * given * given - (temperature - 25.0))
        )
        strength = scale * (1.0 - derating * np.maximum(temperature - 25.0, 0.0))
        if tick >= 0:
            recorded["position"][tick], recorded["velocity"][tick] = angle, v[:, m:]
            recorded["encoder"][tick], recorded["speed"][tick] = encoder, speed
            recorded["motor_velocity"][tick], recorded["command"][tick] = v[:, :m], fresh
            recorded["drive_torque"][tick], recorded["temperature"][tick] = current, temperature
            recorded["voltage"][tick] = bus
        for _ in range(CONTROL_STEPS):
            current += lag * (wanted - current)
            np.multiply(current, strength, out=given)
            stretch = (state @ split)[:, :, 0]
            taut = stretch[0] - np.clip(stretch[0], -play, play) if has_play else stretch[0]
            pull = stiff * taut
            rated = drag_rate * stretch[1]
            pull += rated * (taut != 0) if has_play else rated
            pull *= soften
            np.negative((pull[:, None] @ back)[:, 0], out=force)
            magnitude = np.abs(v)
            level = v / stribeck
            level *= level
            np.negative(level, out=level)
            np.exp(level, out=level)
            level *= excess
            level += coulomb
            if has_load:
                level += load * np.abs(force)
            if has_patch:
                level[:, m:] += patch * (np.abs(x[:, m:] - patch_middle) < 0.15)
            level += 1e-12
            magnitude *= slide
            magnitude /= level
            magnitude += 1.0
            fresh_bristles = bristles + gain * v
            fresh_bristles /= magnitude
            np.subtract(fresh_bristles, bristles, out=rates)
            rates *= BRISTLE_DAMPING / h
            rates += fresh_bristles
            rates *= size
            rates += viscous * v
            bristles = fresh_bristles
            force -= rates
            if has_extra:
                q, qd = x[:, m:], v[:, m:]
                bent = q - rest
                memory = (memory + 4.0 * h * qd) / (1.0 + 4.0 * h * np.abs(qd))
                thrust = push * (np.maximum(np.sin(2 * np.pi * beat * (tick * control)), 0.0) ** 6)
                force[:, m:] += (
                    thrust
                    - spring * (q - spring_rest)
                    - hysteresis * memory
                    - hardening * bent**3
                    - (coupling @ bent[:, :, None])[:, :, 0]
                    - drag * qd * np.abs(qd)
                )
            force[:, :m] += given
            if has_motor_extra:
                turned = x[:, :m]
                force[:, :m] += cogging * np.sin(order * turned + phase) + ripple * given * (
                    np.sin(5 * turned + 0.4) + 0.6 * np.sin(7 * turned + 1.9)
                )
            joints = force[:, m:]
            for i in range(b):
                joints[i] = aba(models[i], datas[i], x[i, m:], v[i, m:], joints[i])
            force[:, :m] *= inverse_rotor
            force *= h
            v += force
            x += h * v
        if tick >= 0:
            recorded["pull"][tick] = -(pull[:, None] @ back)[:, 0][:, m:]
            if energy:
                energies[tick] = [
                    pin.computeMechanicalEnergy(models[i], datas[i], x[i, m:], v[i, m:])
                    + 0.5 * (v[i, :m] ** 2 / inverse_rotor[i]).sum()
                    + 0.5 * (stiff[i] * (x[i] @ split[i]) ** 2).sum()
                    for i in range(b)
                ]
    return traces_of(recorded, energies, control)


def _stiff_belts(
    plants: Sequence[RigPlant],
    stiff: np.ndarray,
    damp: np.ndarray,
    inverse_rotor: np.ndarray,
    matrix: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Of belts whose resonance the step cannot follow, a linearly implicit pull: time ahead [s] and
    factor, `(b, m)` each.
    """
    mobility = inverse_rotor.copy()
    for row, plant in enumerate(plants):
        inverse = inverse_inertia(plant)
        mobility[row] += np.einsum("im,ij,jm->m", matrix[row], inverse, matrix[row])
    fast = (STEP * np.sqrt(stiff * mobility) > 0.35) | (STEP * damp * mobility > 0.2)
    return np.where(fast, STEP, 0.0), np.where(
        fast, 1.0 / (1.0 + STEP * (damp + STEP * stiff) * mobility), 1.0
    )


def _lost(share: np.ndarray, count: int, tick: float, seeds: Sequence[int]) -> np.ndarray:
    """Ticks at which no command arrives `(b, count)`: a two-state process with bursts of 40 ms."""
    lost = np.zeros((share.size, count), bool)
    for row, (part, seed) in enumerate(zip(share, seeds, strict=True)):
        if part > 0:
            rng, at = np.random.default_rng(seed), 0
            while at < count:
                at += round(rng.exponential(0.04 * (1 - part) / part) / tick) + 1
                length = round(rng.exponential(0.04) / tick) + 1
                lost[row, at : at + length] = True
                at += length
    return lost
