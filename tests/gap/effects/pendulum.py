"""A pendulum on a servo, integrated at 0.1 ms in plain numbers, away from the code under test: it
has every effect built in.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject

STEP = 1e-4
RATE = 200
MASS, LENGTH, INERTIA, ROTOR = 1.0, 0.2, 0.01, 0.02
STIFFNESS, DAMPING = 40.0, 2.0
MJCF = f"""
<mujoco model="pendulum">
  <worldbody>
    <body name="arm" pos="0 0 1">
      <joint name="swing" axis="0 1 0" armature="{ROTOR}"/>
      <inertial pos="0 0 {-LENGTH}" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} 0.001"/>
    </body>
  </worldbody>
  <actuator><motor name="servo" joint="swing"/></actuator>
</mujoco>
"""


@dataclass(frozen=True)
class Wrong:
    """What the pendulum has beyond its model."""

    coulomb: float = 0.0
    breakaway: float = 0.0
    stribeck_speed: float = 0.1
    share: float = 0.0
    viscous: float = 0.0
    rotor_viscous: float = 0.0
    """Of the rotor of a drive that gives or has play."""
    constant: float = 1.0
    limit: float = math.inf
    derating: float = 0.0
    delay: float = 0.0
    late_target: float = 0.0
    """By which targets alone come late [s]."""
    lag: float = 0.0
    rotor: float = 0.0
    compliance: float = 0.0
    damping_ratio: float = 0.05
    play: float = 0.0
    ratio: float = 1.0
    offset: float = 0.0
    stiffness_scale: float = 1.0
    damping_scale: float = 1.0
    cosine: float = 0.0
    sine: float = 0.0
    order: float = 1.0
    stiffness: float = 0.0
    preload: float = 0.0
    follow: float = 0.0
    """Share of the missing voltage that torques lose."""
    motor_side: bool = False
    """Position of the rotor is logged and controlled."""


def waves(time: float) -> float:
    """Several frequencies, with two reversals a second."""
    ramp = 1 - math.exp(-((time / 0.5) ** 2))
    return ramp * (
        0.5 * math.sin(1.9 * time) + 0.25 * math.sin(5.3 * time + 1) + 0.08 * math.sin(14.0 * time)
    )


def steps(time: float) -> float:
    """Slow ramps between holds of two seconds."""
    phase = time % 8.0
    if phase < 2:
        return 0.4 * phase / 2
    if phase < 4:
        return 0.4
    if phase < 6:
        return 0.4 - 0.8 * (phase - 4) / 2
    return -0.4 + 0.4 * (phase - 6) / 2 * (phase >= 6)


def temperature(time: float) -> float:
    return 25 + 6 * time


def voltage(time: float) -> float:
    return 24 - 0.5 * time


def run(
    wrong: Wrong = Wrong(),
    duration: float = 8.0,
    target=waves,
    *,
    sees: tuple[str, ...] = ("motor_torque",),
    gains=(STIFFNESS, DAMPING),
) -> Log:
    """Log at 200 Hz; `sees` of motor_torque, motor_torque_command, motor_velocity, temperature,
    voltage, and joint_torque of a sensor between gear and link. Targets and state always.
    """
    link = INERTIA + MASS * LENGTH**2
    rotor = ROTOR + wrong.rotor
    two = wrong.compliance > 0 or wrong.play > 0
    stiff = 1 / wrong.compliance if wrong.compliance > 0 else 2e4
    belt_damping = 2 * wrong.damping_ratio * math.sqrt(stiff * rotor)
    if wrong.play:
        belt_damping = 0.3 * math.sqrt(stiff * rotor)
    q = target(0.0) - wrong.offset
    v, angle, speed, bristle, given = 0.0, q, 0.0, 0.0, 0.0
    late = [0.0] * max(round(wrong.delay / STEP), 1)
    every, rows = round(1 / (RATE * STEP)), []
    bristle_way, count = 5e-4, round(duration / STEP)
    for tick in range(count):
        time = tick * STEP
        told, told_speed = (angle, speed) if wrong.motor_side else (q, v)
        told += wrong.offset
        command = (
            wrong.stiffness_scale * gains[0] * (target(max(time - wrong.late_target, 0.0)) - told)
            - wrong.damping_scale * gains[1] * told_speed
        )
        wanted = command
        if wrong.delay:
            late.append(command)
            wanted = late.pop(0)
        missing = 1 - voltage(time) / 24
        wanted *= 1 - wrong.follow * missing
        wanted = max(-wrong.limit, min(wrong.limit, wanted))
        given = (
            given + (wanted - given) * (1 - math.exp(-STEP / wrong.lag))
            if wrong.lag and tick
            else wanted
        )
        if tick % every == 0:
            rows.append((time, told, told_speed, target(time), command, given, speed))
        torque = given * wrong.constant * (1 - wrong.derating * (temperature(time) - 25))
        torque -= wrong.cosine * math.cos(wrong.order * angle) + wrong.sine * math.sin(
            wrong.order * angle
        )
        gravity = MASS * 9.81 * LENGTH * math.sin(q)
        load = torque * wrong.ratio
        if two:
            bent = angle - q
            free = max(-wrong.play / 2, min(wrong.play / 2, bent))
            load = stiff * (bent - free) + (belt_damping * (speed - v) if bent != free else 0.0)
            speed += STEP * (torque - load - wrong.rotor_viscous * speed) / rotor
            angle += STEP * speed
        elif wrong.share:
            # what reaches the joint of a rigid drive: less what turns the rotor
            load = torque - rotor * (torque - gravity - bristle) / (link + rotor)
        before = v
        size = (
            wrong.coulomb
            + wrong.breakaway * math.exp(-((v / wrong.stribeck_speed) ** 2))
            + wrong.share * abs(load)
        )
        pull = load if two else torque * wrong.ratio
        force = pull - gravity - wrong.viscous * v - wrong.stiffness * q - wrong.preload
        inertia = link if two else link + rotor * wrong.ratio**2
        if size:
            # a bristle that bends and slides (Dahl), taken implicitly
            moved = bristle + size / bristle_way * STEP * v
            moved /= 1 + STEP * abs(v) / bristle_way
            damping = 0.5 * math.sqrt(size / bristle_way * inertia)
            v = (v + STEP * (force - moved) / inertia) / (
                1 + STEP * (damping * (abs(moved) < 0.9 * size)) / inertia
            )
            bristle = moved
        else:
            v += STEP * force / inertia
        if tick % every == 0:
            held = link * (v - before) / STEP + gravity + wrong.stiffness * q + wrong.preload
            rows[-1] += (held,)
        q += STEP * v
        if not two:
            angle, speed = q * wrong.ratio, v * wrong.ratio
    table = np.array(rows)
    time = table[:, 0]
    signals = {
        "position/swing": table[:, 1],
        "velocity/swing": table[:, 2],
        "position_target/swing": table[:, 3],
    }
    if "motor_torque_command" in sees:
        signals["motor_torque_command/swing"] = table[:, 4]
    if "motor_torque" in sees:
        signals["motor_torque/swing"] = table[:, 5]
    if "joint_torque" in sees:
        signals["joint_torque/swing"] = table[:, 7]
    if "motor_velocity" in sees:
        signals["motor_velocity/swing"] = table[:, 6]
    if "temperature" in sees:
        signals["motor_temperature/swing"] = np.array([temperature(t) for t in time])
    if "voltage" in sees:
        signals["battery_voltage"] = np.array([voltage(t) for t in time])
    sensors = ("swing",) if "joint_torque" in sees else ()
    return Log("pendulum", time, signals, Metadata(gains={"swing": gains}, torque_sensors=sensors))


def subject(folder, log: Log):
    """The pendulum's nominal model."""
    path = folder / "pendulum.xml"
    path.write_text(MJCF)
    return load_subject(path, [log])


def conditioned(folder, wrong: Wrong = Wrong(), **options):
    """Signals of a run."""
    log = run(wrong, **options)
    return condition(log, subject(folder, log))


def low_passed(values: np.ndarray, step: float, cutoff: float = 10.0) -> np.ndarray:
    """No delay, along time `(t,)`."""
    from scipy.signal import butter, sosfiltfilt

    return sosfiltfilt(butter(2, cutoff, fs=1 / step, output="sos"), values)


def misfit(signals, trace: dict, residual_name: str = "motion") -> float:
    """Rms of residual minus trace over that of the residual, both low-passed."""
    found = low_passed(signals.residual[residual_name][:, 0], signals.step)
    told = (
        low_passed(trace[residual_name][0, :, 0], signals.step) if residual_name in trace else 0.0
    )
    use = signals.valid
    return float(np.sqrt(np.mean((found - told)[use] ** 2) / np.mean(found[use] ** 2)))
