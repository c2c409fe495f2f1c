"""Logs of small robots with something wrong, made in plain MuJoCo, for tests of the diagnosis."""

from __future__ import annotations

from functools import cache

import numpy as np
import robots

from hyperleg_design.gap.inference.assembly import evidence_of
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject

CHANGES = {
    "healthy": [],
    "viscous": [
        ('name="knee" axis="0 1 0" damping="0.03"', 'name="knee" axis="0 1 0" damping="0.33"')
    ],
    "dry": [
        (
            'name="hip" axis="0 1 0" damping="0.05"',
            'name="hip" axis="0 1 0" damping="0.05" frictionloss="0.8"',
        )
    ],
    "both": [
        ('name="knee" axis="0 1 0" damping="0.03"', 'name="knee" axis="0 1 0" damping="0.33"'),
        (
            'name="hip" axis="0 1 0" damping="0.05"',
            'name="hip" axis="0 1 0" damping="0.05" frictionloss="0.8"',
        ),
    ],
    "rubbing": [
        (
            'name="hip" axis="0 1 0" damping="0.05"',
            'name="hip" axis="0 1 0" damping="0.3" frictionloss="0.4"',
        ),
    ],
    "cubic": [],
    "cubic_faint": [],
    "rounded": [],
    "limited": [
        (
            'name="m_front" tendon="front" ctrlrange="-4 4"',
            'name="m_front" tendon="front" ctrlrange="-0.5 0.5"',
        )
    ],
}


HARDENING = {"cubic": 4.0 / 12, "cubic_faint": 1 / 600}
"""Torque of the spring that hardens, at each motor over the cube of the hip's angle [Nm/rad^3]; the
faint one is within what a check of the drives' torques lets pass."""
ROUNDED = 0.2
"""Friction at each motor that reverses over 0.3 rad/s of the hip [Nm]."""


def run(kind: str, seed: int, **metadata):
    """Log of the coupled rig, as noisy as a cheap robot's."""
    log = _run(kind, seed)
    return log.changed(metadata=log.metadata.changed(**metadata))


@cache
def _run(kind: str, seed: int):
    text = robots.COUPLED
    for old, new in CHANGES[kind]:
        assert old in text
        text = text.replace(old, new)
    target = robots.waves(2, [1.5, 1.5], seed=seed)
    log = robots.servo_run(text, target, 12.0)
    rng = np.random.default_rng([7, seed])
    noise = {"position": 5e-5, "velocity": 5e-3, "motor_torque": 5e-3}
    signals = {
        c: v + rng.normal(0, noise[c.partition("/")[0]], len(v)) for c, v in log.signals.items()
    }
    if kind in HARDENING:  # no effect has such a torque: a spring at the hip that hardens
        pull = HARDENING[kind] * log.column("position/hip") ** 3
        for motor in ("m_front", "m_back"):
            signals[f"motor_torque/{motor}"] = signals[f"motor_torque/{motor}"] + pull
    if kind == "rounded":
        for motor in ("m_front", "m_back"):
            rubs = ROUNDED * np.tanh(log.column("velocity/hip") / 0.3)
            signals[f"motor_torque/{motor}"] = signals[f"motor_torque/{motor}"] + rubs
    if kind == "limited":
        asked = np.array([target(t) for t in log.time])
        signals |= {
            f"motor_torque_command/{motor}": asked[:, i]
            for i, motor in enumerate(("m_front", "m_back"))
        }
    return log.changed(signals=signals, name=f"{kind}_{seed}")


def stamped_badly(seed: int):
    """Targets and positions of two healthy servos, by a clock that is a quarter of a millisecond
    early or late.
    """
    log = robots.servo_run(robots.SERVOS, robots.waves(2, [0.6, 0.8], seed=seed), 12.0)
    late = np.random.default_rng([8, seed]).uniform(-2.5e-4, 2.5e-4, len(log.time))
    return robots.without(log, "velocity", "motor_torque").changed(
        time=log.time + late, name=f"stamped_badly_{seed}"
    )


def soft_servos(seed: int, share: float = 0.75):
    """Targets, positions and torques of two servos, both softer than they declare."""
    text = robots.SERVOS
    for gain in (200, 120):
        text = text.replace(f'kp="{gain}"', f'kp="{share * gain:g}"')
    log = robots.servo_run(text, robots.waves(2, [0.6, 0.8], seed=seed), 12.0)
    noise = np.random.default_rng([9, seed])
    signals = {c: v + noise.normal(0, 2e-5, len(v)) for c, v in log.signals.items()}
    log = log.changed(signals=signals, name=f"soft_{share:g}_{seed}")
    return robots.without(log, "velocity", "motor_torque")


def conditioned(robot, *logs):
    """Signals of logs of one robot."""
    subject = load_subject(robot, logs)
    return [condition(log, subject) for log in logs]


def evidence(robot, *logs, references=()):
    """What causes are judged on."""
    signals = conditioned(robot, *logs, *references)
    return evidence_of(signals[: len(logs)], signals[len(logs) :], InferenceRules())


def diagnosis(robot_files, kind: str, seeds=(0, 1), references=()):
    """Diagnosis of two logs of the coupled rig, with logs of the healthy one from another day."""
    logs = [run(kind, seed, session="today") for seed in seeds]
    healthy = [run("healthy", seed, session="before", role="reference") for seed in references]
    return diagnose(robot_files["coupled"], logs, healthy, threads=1)
