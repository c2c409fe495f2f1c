"""Hopping on the spot with both feet: push-off, flight, landing, over and over.

The ground's force is vertical and passes through the centre of mass, which stays over the middle of
the soles; it is a smooth pulse in stance and nothing in flight, where the centre of mass falls
freely. The angular momentum about the centre of mass stays zero: the pelvis leans forward at the
deepest point and swings back as the legs extend.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot.kinematics.tree import SIGN
from hyperleg_design.robot.models import GRAVITY, rigid_body_model
from hyperleg_design.robot.names import SIDES
from hyperleg_design.sizing.motions.balance import highest_pelvis
from hyperleg_design.sizing.motions.foot_path import FLAT, SWING, FootPath, bump
from hyperleg_design.sizing.motions.motion import (
    Motion,
    PelvisPath,
    check_positive,
    check_ranges,
    contact_mask,
    ground_wrench,
    joint_states,
)
from hyperleg_design.sizing.motions.squat import sole_middle

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.models import RigidBodyModel

NEWTON_STEPS = 12
"""Most steps that bring the centre of mass to its place in one posture."""
CLOSE = 1e-11
"""Distance from its place at which the centre of mass is there [m]."""


@dataclass(frozen=True, kw_only=True)
class HopPlan:
    """Pace of the hops; all assumed."""

    stance: float = 0.30
    """Feet down [s]."""
    flight: float = 0.12
    """Feet up [s]; the centre of mass rises by g flight^2 / 8 meanwhile."""
    min_knee: float = 1.0
    """Knee flexion at the straightest moment, were the trunk upright [rad]; straighter legs spin a
    light trunk too fast."""
    lean: float = 0.45
    """Pitch of the pelvis at the deepest point [rad]; it swings back as the legs extend, as a
    jumper's trunk does."""

    def __post_init__(self) -> None:
        check_positive("hop", stance=self.stance, flight=self.flight, min_knee=self.min_knee)

    @property
    def touchdown_speed(self) -> float:
        """Speed at which the centre of mass comes down [m/s]."""
        return GRAVITY * self.flight / 2

    @property
    def rise(self) -> float:
        """Rise of the centre of mass in flight [m]."""
        return GRAVITY * self.flight**2 / 8


def hop(design: Design, plan: HopPlan | None = None, samples: int = 60) -> Motion:
    """Plan one hop of a steady series, from touchdown to touchdown.

    Args:
        design: a robot, of any variant.
        plan: stance and flight.
        samples: in a hop.

    Returns:
        The motion.

    Raises:
        InfeasibleError: a joint's range ends before, or the corrections do not settle.
        InputError: a plan that makes no sense.
    """
    plan = plan or HopPlan()
    if samples < 40:
        raise InputError("hop", "samples", samples, "expects at least 40")
    model = rigid_body_model(design)
    period = plan.stance + plan.flight
    time = np.arange(samples) * period / samples
    feet = _feet(design, plan, time)
    flying = feet[0].phase == SWING
    q, v, a = _Hop(model, plan).states(time)
    check_ranges(model, q)
    pressure = np.zeros((samples, 3))
    pressure[:, 0] = sole_middle(design)
    pressure[flying] = np.nan
    assumed = {
        "hop": f"{plan.stance:g} s of stance, {plan.flight:g} s of flight, the centre of mass "
        f"{100 * plan.rise:.1f} cm up in flight (assumed)",
        "force": f"a vertical pulse of at most {load_pulse(plan, time)[2].max():.2f} body weights "
        f"under the middle of the soles (assumed)",
        "trunk": f"leans forward by {np.rad2deg(plan.lean):.0f} deg at the deepest point and "
        f"swings back; no angular momentum, feet flat (assumed)",
    }
    return Motion(
        "hop", model, time, q, v, a, contact_mask(model, feet), feet, pressure, True, 0.0, assumed
    )


def load_pulse(plan: HopPlan, time: np.ndarray) -> np.ndarray:
    """Compute the height of the centre of mass and the vertical force over one hop.

    The force is a smooth pulse `u^2 (3 - 2 u)`, u = 4 s (1 - s), in stance and zero in flight, 1 on
    average.

    Args:
        plan: stance and flight.
        time: within one hop, from touchdown [s], `(n,)`.

    Returns:
        Height over that at touchdown [m], its rate [m/s], and the vertical force over weight [-],
        `(3, n)`.
    """
    time = np.asarray(time, float)
    height, rate, pulse = _pulse(plan)
    s = np.clip(time / plan.stance, 0.0, 1.0)
    air = np.maximum(time - plan.stance, 0.0)
    return np.stack(
        [
            plan.stance * height(s) + air * (plan.touchdown_speed - GRAVITY * air / 2),
            rate(s) - GRAVITY * air,
            np.where(air > 0, 0.0, pulse(s)),
        ]
    )


@cache
def _pulse(plan: HopPlan) -> tuple[np.polynomial.Polynomial, ...]:
    """Height over the duration of stance [m/s], its rate [m/s] and the force over weight [-], of
    the share of stance that is over.
    """
    u = 4 * np.polynomial.Polynomial([0.0, 1.0, -1.0])
    shape = u**2 * (3 - 2 * u)
    pulse = shape * ((plan.stance + plan.flight) / plan.stance / shape.integ()(1.0))
    fallen = plan.stance * GRAVITY * (pulse.integ() - np.polynomial.Polynomial([0.0, 1.0]))
    rate = fallen - plan.touchdown_speed
    return rate.integ(), rate, pulse


def _feet(design: Design, plan: HopPlan, time: np.ndarray) -> tuple[FootPath, FootPath]:
    flying = time >= plan.stance
    feet = []
    for side in SIDES:
        position = np.zeros((3, len(time), 3))
        position[0] = [0.0, SIGN[side] * design.hip.spacing / 2, design.foot.ankle_height]
        position[:, flying, 2] += bump(
            time[flying], plan.stance, plan.stance + plan.flight, plan.rise
        )
        still = np.zeros((3, len(time)))
        feet.append(FootPath(position, still, still, np.where(flying, SWING, FLAT)))
    return feet[0], feet[1]


@dataclass(frozen=True, eq=False)
class _Hop:
    """The hop's three conditions (place of the centre of mass, no spin) solved for the pelvis's
    place and pitch.
    """

    model: RigidBodyModel
    plan: HopPlan

    def states(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Compute the states at times within one hop.

        Args:
            time: from touchdown [s], `(n,)`.

        Returns:
            Configurations, velocities and accelerations in Pinocchio's coordinates, `(n, ...)`
            each.
        """
        design, plan = self.model.design, self.plan
        middle, rise = sole_middle(design), load_pulse(plan, time)[0]
        # the straightest moment, upright and over the middle of the soles, fixes how high the
        # centre of mass may be
        over = np.stack([np.full(len(time), middle), 0 * time], -1)
        rooms = [
            highest_pelvis(
                design, over[[n]], _feet(design, plan, time[[n]]), rise[[n]], plan.min_knee
            )
            for n in range(len(time))
        ]
        straightest = int(np.argmin(rooms))
        posture = np.array([middle, rooms[straightest] + rise[straightest], 0.0])
        touchdown = (
            self.model.center_of_mass(
                self._row(time[[straightest]], posture, *np.zeros((2, 1, 3)))[0][0]
            )[2]
            - rise[straightest]
        )
        guess = np.array(
            [
                middle,
                rooms[straightest] + load_pulse(plan, np.array([plan.stance / 2]))[0, 0],
                plan.lean,
            ]
        )

        # no spin fixes the pitch's rate: integrate from the deepest point, where the motion turns
        # back on itself
        period = plan.stance + plan.flight
        wanted = np.abs((time - plan.stance / 2 + period / 2) % period - period / 2)
        marks = np.unique(np.round(np.concatenate([[0.0], wanted]), 12))
        places = {0.0: self._placed(0.0, guess, touchdown)}
        for begin, end in itertools.pairwise(marks):
            places[float(end)] = self._stepped(
                float(begin), float(end), places[float(begin)], touchdown
            )
        q, v, a = (
            np.zeros((len(time), size))
            for size in (self.model.model.nq, self.model.model.nv, self.model.model.nv)
        )
        for n, moment in enumerate(time):
            place = places[float(np.round(wanted[n], 12))]
            speed = self._speed(float(moment), place)
            q[n], v[n], a[n] = self._thrust(float(moment), place, speed)
        return q, v, a

    def _row(
        self, time: np.ndarray, place: np.ndarray, speed: np.ndarray, thrust: np.ndarray
    ) -> tuple[np.ndarray, ...]:
        """States with the pelvis at `(x, z, pitch)`, for each row of its rates and accelerations
        `(rows, 3)`.
        """
        rows = len(speed)
        moved = np.stack([np.broadcast_to(place, (rows, 3)), speed, thrust])
        position = np.stack([moved[..., 0], np.zeros((3, rows)), moved[..., 1]], -1)
        feet = _feet(self.model.design, self.plan, np.full(rows, time[0]))
        return joint_states(
            self.model, PelvisPath(position, moved[..., 2], np.zeros((3, rows))), feet
        )

    def _since_touchdown(self, late: float) -> np.ndarray:
        """Time within the hop of a time after its deepest point, `(1,)` [s]."""
        return np.array([(late + self.plan.stance / 2) % (self.plan.stance + self.plan.flight)])

    def _placed(self, late: float, place: np.ndarray, touchdown: float) -> np.ndarray:
        """The place, its x and z moved until the centre of mass is where it should be."""
        moment = self._since_touchdown(late)
        target = np.array(
            [sole_middle(self.model.design), touchdown + load_pulse(self.plan, moment)[0, 0]]
        )
        placed = place.copy()
        for _ in range(NEWTON_STEPS):
            q, v, _ = self._row(moment, placed, np.eye(3)[:2], np.zeros((2, 3)))
            miss = target - self.model.center_of_mass(q[0])[[0, 2]]
            if np.max(np.abs(miss)) < CLOSE:
                return placed
            slope = (
                self._momenta(q, v)[:, :2].T
                - self._momenta(*self._row(moment, placed, np.zeros((1, 3)), np.zeros((1, 3)))[:2])[
                    :, :2
                ].T
            )
            placed[:2] += np.linalg.solve(slope / self._mass, miss)
        raise InfeasibleError(
            f"{self.model.design.name}: no posture puts the centre of mass where the hop needs it"
        )

    def _stepped(self, begin: float, end: float, place: np.ndarray, touchdown: float) -> np.ndarray:
        """One step of the classical Runge-Kutta method in the pitch."""
        span = end - begin

        def rate(late: float, pitch: float, near: np.ndarray) -> tuple[float, np.ndarray]:
            at = self._placed(late, np.array([near[0], near[1], pitch]), touchdown)
            return float(self._speed(float(self._since_touchdown(late)[0]), at)[2]), at

        k1, at = rate(begin, place[2], place)
        k2, at = rate(begin + span / 2, place[2] + span / 2 * k1, at)
        k3, at = rate(begin + span / 2, place[2] + span / 2 * k2, at)
        k4, at = rate(end, place[2] + span * k3, at)
        pitch = place[2] + span / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return self._placed(end, np.array([at[0], at[1], pitch]), touchdown)

    def _speed(self, moment: float, place: np.ndarray) -> np.ndarray:
        """Rates of the pelvis at which the centre of mass moves as planned and nothing spins,
        `(3,)`.
        """
        q, v, _ = self._row(
            np.array([moment]),
            place,
            np.concatenate([np.zeros((1, 3)), np.eye(3)]),
            np.zeros((4, 3)),
        )
        momenta = self._momenta(q, v)
        target = np.array([0.0, self._mass * load_pulse(self.plan, np.array([moment]))[1, 0], 0.0])
        return np.linalg.solve((momenta[1:] - momenta[0]).T, target - momenta[0])

    def _thrust(
        self, moment: float, place: np.ndarray, speed: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The state, with accelerations of the pelvis at which the ground's force is the planned
        one.
        """
        rows = np.concatenate([np.zeros((1, 3)), np.eye(3)])
        q, v, a = self._row(np.array([moment]), place, np.broadcast_to(speed, (4, 3)), rows)
        force, moments = ground_wrench(self.model, q, v, a)
        needed = np.stack([force[:, 0], force[:, 2], moments[:, 1]], -1)
        load = self._mass * GRAVITY * load_pulse(self.plan, np.array([moment]))[2, 0]
        target = np.array([0.0, load, -sole_middle(self.model.design) * load])
        thrust = np.linalg.solve((needed[1:] - needed[0]).T, target - needed[0])
        return q[0], v[0], a[0] + thrust @ (a[1:] - a[0])

    def _momenta(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Momentum along x and z, and about y through the centre of mass, `(rows, 3)`."""
        import pinocchio as pin

        momenta = np.zeros((len(q), 3))
        for n in range(len(q)):
            momentum = pin.computeCentroidalMomentum(self.model.model, self.model.data, q[n], v[n])
            momenta[n] = momentum.linear[0], momentum.linear[2], momentum.angular[1]
        return momenta

    @property
    def _mass(self) -> float:
        return self.model.tree.mass
