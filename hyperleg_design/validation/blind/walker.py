"""A robot on its feet at one place on one day: its plants with any faults, and the logs of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.validation.blind.plants.nuisance import Nuisance, built
from hyperleg_design.validation.blind.plants.rig_build import build_rig, tilted
from hyperleg_design.validation.blind.plants.stand import Stand
from hyperleg_design.validation.blind.plants.walking import (
    Ground,
    WalkingPlant,
    WalkingTrace,
    simulate_walking,
    walking_model,
)
from hyperleg_design.validation.blind.recorder import Recorder
from hyperleg_design.validation.blind.robots.chain import GRAVITY, Chain, steiner
from hyperleg_design.validation.blind.robots.tree_links import matrix
from hyperleg_design.validation.blind.walking_record import walking_log
from hyperleg_design.validation.blind.wrong import Wrong

BASE = "pelvis"
"""Body that carries the robot's payload and is pushed."""
NOMINAL_GROUND = (2.5e4, 230.0)
"""Stiffness [1/s^2] and damping [1/s] of the plant's own contact; about as deep as the simulator's
at rest."""


@dataclass(frozen=True)
class Floor:
    """What stays with one place and one pelvis."""

    friction: float
    stiffness: float
    """Over the nominal [-]."""
    pelvis: float
    """True mass of the pelvis over the drawing's [-]."""


@dataclass(frozen=True, eq=False)
class Walker:
    """A robot with what is off in it, its floor and its recorder."""

    chain: Chain
    day: Nuisance
    floor: Floor
    recorder: Recorder

    def plant(self, wrongs: Sequence[Wrong]) -> WalkingPlant:
        """The plant with some faults.

        Args:
            wrongs: the faults; none for the healthy robot.

        Returns:
            The plant.
        """
        gravity, masses, push, loads = GRAVITY.copy(), built(self.chain, self.day), np.zeros(3), []
        friction, stiffness = self.floor.friction, self.floor.stiffness
        gyro, accelerometer, frequency = np.zeros(3), np.zeros(3), 1.0
        drives: list[Wrong] = []
        for w in wrongs:
            axis = np.array([w.shape.get(a, 0.0) for a in "xyz"])
            if w.effect == "tilted_gravity":
                gravity = tilted(w.size, w.shape["heading"])
            elif w.effect == "periodic_push":
                push, frequency = 400.0 * w.size * np.array([0.5, 1.0, 0.0]), w.shape["frequency"]
            elif w.effect == "imu_bias":
                gyro = w.shape["gyro"] * w.size * axis
                accelerometer = (1 - w.shape["gyro"]) * 10.0 * w.size * axis
            elif w.effect == "ground_friction":
                friction *= 1.0 - w.size
            elif w.effect == "ground_compliance":
                stiffness /= w.size
            elif w.effect == "payload":
                loads.append((w.size, axis))
            elif w.effect == "link_mass":
                link = next(link for link in self.chain.links if link.name == w.location)
                own = next(link for link in masses.links if link.name == w.location)
                masses = masses.with_link(
                    link.name,
                    mass=own.mass + w.size * link.mass,
                    inertia=own.inertia * (1 + w.size),
                )
            else:
                drives.append(w)
        ground = Ground(
            friction, NOMINAL_GROUND[0] * stiffness, NOMINAL_GROUND[1] * np.sqrt(stiffness)
        )
        model = walking_model(self.chain, masses, ground, self.floor.pelvis, gravity)
        for mass, place in loads:
            _hang(model, mass, place)
        return WalkingPlant(
            model,
            replace(build_rig(self.chain, self.day, drives), push_frequency=frequency),
            gyro,
            accelerometer,
            push,
        )

    def trace(
        self, wrongs: Sequence[Wrong], stand: Stand, duration: float, seed: int
    ) -> tuple[WalkingPlant, WalkingTrace]:
        """A plant with some faults, and what truly happened in a run of it.

        Args:
            wrongs: the faults.
            stand: the motion.
            duration: of the recording [s].
            seed: of lost commands.

        Returns:
            The plant and the trace.
        """
        plant = self.plant(wrongs)
        return plant, simulate_walking(plant, self.chain, stand, duration, self.recorder.rate, seed)

    def log(
        self, run: tuple[WalkingPlant, WalkingTrace], seed: int, name: str, **metadata: Any
    ) -> Log | None:
        """Record a run as a log; None where the robot fell.

        Args:
            run: the plant and the trace of its run.
            seed: of the recording.
            name: of the log.
            metadata: of the log.

        Returns:
            The log, or None.
        """
        plant, trace = run
        return (
            None
            if trace.fell
            else walking_log(
                plant, trace, self.chain, self.recorder, np.random.default_rng(seed), name, metadata
            )
        )


def _hang(model: Any, mass: float, place: np.ndarray) -> None:
    """Put a point mass on the pelvis of a compiled model."""
    import mujoco

    body = model.body(BASE).id
    own = float(model.body_mass[body])
    com = model.body_ipos[body].copy()
    axes = matrix(model.body_iquat[body])
    total = own + mass
    middle = (own * com + mass * place) / total
    inertia = (
        axes @ np.diag(model.body_inertia[body]) @ axes.T
        + steiner(own, com - middle)
        + steiner(mass, place - middle)
    )
    values, turned = np.linalg.eigh(inertia)
    if np.linalg.det(turned) < 0:
        turned[:, 0] *= -1
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, turned.ravel())
    model.body_mass[body] = total
    model.body_ipos[body] = middle
    model.body_inertia[body] = values
    model.body_iquat[body] = quaternion
    mujoco.mj_setConst(model, mujoco.MjData(model))
