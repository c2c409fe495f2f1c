"""Cases of the quadruped on its feet: what is wrong, which motions tests and references have, and
the truth.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from typing_extensions import override

from hyperleg_design.validation.benchmark.case import Case, Fault, Material, Recording, Truth
from hyperleg_design.validation.newcomers import quadruped
from hyperleg_design.validation.newcomers.case_plan import CasePlan, development_cases
from hyperleg_design.validation.newcomers.names import fault_of
from hyperleg_design.validation.newcomers.plant import Wrong
from hyperleg_design.validation.newcomers.quadruped import Run
from hyperleg_design.validation.newcomers.quadruped_log import FEET, JOINTS

DURATION = 10.0
"""Of each log [s]."""
USUAL = ("sway", "trot")
"""Motions of tests and references where a case says nothing else."""
OTHER = ("squat", "crawl")
"""Motions that no reference has."""
ROBOTS = 3
"""Robots that were built; each case has one of them."""
AXES = ("gyro_x", "gyro_y", "gyro_z")


@dataclass(frozen=True)
class QuadrupedPlan(CasePlan):
    """One case of the quadruped."""

    tests: tuple[str, ...] = USUAL
    references: tuple[str, ...] = USUAL
    plain: bool = False
    """Whether the robot's file is the URDF as it comes, which lacks friction and rotors."""
    robot = "quadruped"
    about = "quadruped on its feet"

    @property
    @override
    def identified(self) -> bool:
        return not self.plain

    @property
    def build(self) -> int:
        """Seed of how its robot was built, and of the references' session; `seed` is that of the
        motions, the noise and the session of its tests.
        """
        return 40 + self.seed % ROBOTS

    @override
    def fault(self, wrong: Wrong) -> Fault:
        what, j, size = wrong.what, wrong.place, wrong.size
        now, then = quadruped.session(self.seed), quadruped.session(self.build)
        if what == "slippery":
            return Fault("ground_friction", (FEET[j],), {"scale": size * now.floor / then.floor})
        if what == "soft":
            return Fault("ground_compliance", (FEET[j],))
        if what == "gyro":
            bias = size + float(now.bias[j] - then.bias[j])
            return Fault("imu_bias", ("imu",), {AXES[j]: bias})
        if what == "load":
            joint = "base" if wrong.body == "trunk" else f"{wrong.body}_joint"
            return fault_of(what, (wrong.body, joint), size)
        values = {
            "dry": {"torque": size + quadruped.RUBBING * float(now.rubbing[j] - then.rubbing[j])},
            "rough": {"torque": quadruped.RUBBING * float(size * now.rubbing[j] - then.rubbing[j])},
            "weak": {"scale": size * float(now.torques[j] / then.torques[j])},
            "zero": {"offset": size + float(now.zero[j] - then.zero[j])},
            "rotor": {"inertia": size},
        }.get(what)
        return fault_of(what, (JOINTS[j], JOINTS[j].removesuffix("_joint")), size, values)

    @override
    def material(self, data: Path, duration: float) -> tuple[Material, Truth]:
        tests = tuple(
            quadruped.simulate(
                self.wrongs,
                Run(motion, self.seed + 10 * k, self.build, self.seed, f"test_{k}", duration),
            ).declared(session="test")
            for k, motion in enumerate(self.tests)
        )
        references = tuple(
            _healthy(
                Run(
                    motion,
                    1000 * self.build + 10 * k,
                    self.build,
                    self.build,
                    f"healthy_{k}",
                    duration,
                )
            )
            for k, motion in enumerate(self.references)
        )
        if not self.plain:
            return Material(quadruped.careful_file(), tests, references), self.truth
        tests, references = (tuple(map(_by_joint, logs)) for logs in (tests, references))
        return Material(quadruped.plain_file(), tests, references), self.truth


def _one(label: str, what: str, joint: str, size: float) -> QuadrupedPlan:
    return QuadrupedPlan(label, (Wrong(what, JOINTS.index(f"{joint}_joint"), size),))


def _at_foot(label: str, what: str, foot: str, size: float) -> QuadrupedPlan:
    return QuadrupedPlan(label, (Wrong(what, FEET.index(foot), size),))


TRUNK_LOAD = Wrong("load", size=0.6, body="trunk", at=(0.08, 0.03, 0.09))
CALF_LOAD = Wrong("load", size=0.15, body="RL_calf", at=(0.0, 0.0, -0.15))

PLANS: tuple[QuadrupedPlan, ...] = (
    QuadrupedPlan("nothing-same"),
    QuadrupedPlan("nothing-other", tests=OTHER),
    QuadrupedPlan("nothing-alone", references=()),
    QuadrupedPlan("nothing-plain", plain=True),
    _one("dry-calf", "dry", "RR_calf", 0.45),
    _one("weak-thigh", "weak", "FR_thigh", 0.87),
    _one("zero-calf", "zero", "FL_calf", 0.04),
    QuadrupedPlan("late-8ms", (Wrong("late", size=0.0075),)),
    _one("gain-hip", "gain", "RL_hip", 0.7),
    _one("rotor-calf", "rotor", "FR_calf", 0.012),
    _one("lossy-thigh", "lossy", "FL_thigh", 0.08),
    QuadrupedPlan("load-trunk", (TRUNK_LOAD,)),
    QuadrupedPlan("load-calf", (CALF_LOAD,)),
    _at_foot("slippery-foot", "slippery", "FR_foot", 0.3),
    _at_foot("soft-foot", "soft", "RL_foot", 4.0),
    QuadrupedPlan("gyro-bias", (Wrong("gyro", 0, 0.02),)),
    QuadrupedPlan("rough-everywhere", tuple(Wrong("rough", j, 2.5) for j in range(12))),
    QuadrupedPlan("load-zero", (TRUNK_LOAD, Wrong("zero", JOINTS.index("RR_thigh_joint"), 0.03))),
    QuadrupedPlan("push-trunk", (Wrong("push", size=12.0, body="trunk"),)),
    QuadrupedPlan("rope-calf", (Wrong("rope", size=400.0, body="RR_calf"),)),
    QuadrupedPlan("tilt-floor", (Wrong("tilt", size=0.05),)),
    QuadrupedPlan("lost-packets", (Wrong("lost", size=0.2),)),
    _one("hysteresis-thigh", "hysteresis", "FR_thigh", 0.8),
)
"""In this order; all for development."""


def quadruped_cases() -> list[Case]:
    """List all cases of the quadruped."""
    return development_cases(PLANS, DURATION)


def _by_joint(log: Recording) -> Recording:
    """A copy whose motors are named after their joints: the URDF as it comes names none."""
    columns = {
        f"{name}_joint" if name.startswith("motor_torque") else name: values
        for name, values in log.signals.items()
    }
    return replace(log, signals=columns)


@lru_cache(maxsize=2 * ROBOTS)
def _healthy(run: Run) -> Recording:
    """A log of a healthy robot, which cases share that have the same robot."""
    return quadruped.simulate((), run).declared(session="healthy")
