"""What nobody gets right: the few per cent by which a robot differs from its data sheet, and from
itself on another day.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hyperleg_design.validation.blind.robots.chain import Chain


@dataclass(frozen=True, eq=False)
class Nuisance:
    """Factors and offsets on the nominal values; `l` links, `n` joints, `m` motors."""

    mass: np.ndarray
    """`(l,)`"""
    com: np.ndarray
    """Shift `(l, 3)` [m]."""
    inertia: np.ndarray
    rotor: np.ndarray
    """`(l,)`, `(m,)`"""
    coulomb: np.ndarray
    viscous: np.ndarray
    """`(n,)` each."""
    torque: np.ndarray
    """True torque over what the drive reports `(m,)`."""
    offset: np.ndarray
    """Of the encoders `(n,)` [rad]."""
    breakaway: np.ndarray
    """Static over sliding friction `(n,)`."""
    resonance: np.ndarray
    """Of the belts `(m,)` [Hz]."""
    lag: float
    """Time constant of the torque loop [s]."""
    delay: float
    """From controller to drive [s]."""
    air: float
    """Temperature at which the motors start [degC]."""


def perfect(chain: Chain) -> Nuisance:
    """Build nuisance parameters of a robot that is as its model says, with stiff belts.

    Args:
        chain: the robot.

    Returns:
        The nuisance parameters.
    """
    n, m = chain.joint_from_motor.shape
    joint_scale, motor_scale = np.ones(n), np.ones(m)
    return Nuisance(
        joint_scale,
        np.zeros((n, 3)),
        joint_scale,
        motor_scale,
        joint_scale,
        joint_scale,
        motor_scale,
        np.zeros(n),
        joint_scale,
        np.full(m, 120.0),
        0.0,
        0.0,
        25.0,
    )


def of_robot(chain: Chain, rng: np.random.Generator) -> Nuisance:
    """What stays with one robot for life.

    Args:
        chain: the robot.
        rng: source of randomness.

    Returns:
        The nuisance parameters.
    """
    n, m = chain.joint_from_motor.shape

    def factor(count: int, spread: float) -> np.ndarray:
        return 1.0 + spread * np.clip(rng.standard_normal(count), -2.0, 2.0)

    lengths = np.maximum(np.abs([link.com for link in chain.links]).max(-1), 0.02)
    return Nuisance(
        mass=factor(n, 0.02),
        com=np.clip(rng.standard_normal((n, 3)), -2, 2) * 0.02 * lengths[:, None],
        inertia=factor(n, 0.04),
        rotor=factor(m, 0.04),
        coulomb=factor(n, 0.06),
        viscous=factor(n, 0.08),
        torque=factor(m, 0.012),
        offset=0.0015 * np.clip(rng.standard_normal(n), -2, 2),
        breakaway=np.asarray(1.0 + rng.uniform(0.02, 0.08, n)),
        resonance=np.asarray(rng.uniform(90.0, 150.0, m)),
        lag=rng.uniform(0.0005, 0.0012),
        delay=rng.uniform(0.0002, 0.0008),
        air=25.0,
    )


def of_day(chain: Chain, robot: Nuisance, rng: np.random.Generator) -> Nuisance:
    """The same robot in another session: calibration, temperature and grease differ a little.

    Args:
        chain: the robot.
        robot: its own nuisance parameters.
        rng: source of randomness.

    Returns:
        The nuisance parameters of the session.
    """
    n, m = chain.joint_from_motor.shape
    friction = 1.0 + 0.03 * np.clip(rng.standard_normal(), -2, 2)
    return replace(
        robot,
        coulomb=robot.coulomb * friction * (1 + 0.02 * np.clip(rng.standard_normal(n), -2, 2)),
        viscous=robot.viscous * friction * (1 + 0.03 * np.clip(rng.standard_normal(n), -2, 2)),
        torque=robot.torque * (1 + 0.006 * np.clip(rng.standard_normal(m), -2, 2)),
        offset=robot.offset + 0.0007 * np.clip(rng.standard_normal(n), -2, 2),
        air=rng.uniform(20.0, 38.0),
    )


def built(chain: Chain, nuisance: Nuisance) -> Chain:
    """The robot's true links.

    Args:
        chain: the nominal robot.
        nuisance: what is off.

    Returns:
        The robot as it was built.
    """
    from dataclasses import replace as changed

    links = tuple(
        changed(
            link,
            mass=link.mass * nuisance.mass[i],
            com=link.com + nuisance.com[i],
            inertia=link.inertia * nuisance.inertia[i],
        )
        for i, link in enumerate(chain.links)
    )
    return changed(chain, links=links)
