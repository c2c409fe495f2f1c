"""Plan of a case: what is wrong with a robot, and the motions that tests and references make."""

from __future__ import annotations

import zlib
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TypeVar

from typing_extensions import override

from hyperleg_design.validation.benchmark.case import Case, Fault, Material, Recording, Truth
from hyperleg_design.validation.newcomers.plant import Wrong, everywhere


@dataclass(frozen=True)
class CasePlan(ABC):
    """One case of a robot; its class is the robot's."""

    label: str
    wrongs: tuple[Wrong, ...] = ()
    """What is wrong with the robot of the tests."""
    tests: tuple[str, ...] = ()
    """Motions of the tests, one a log."""
    references: tuple[str, ...] = ()
    """Motions of the references, one a log."""

    @property
    @abstractmethod
    def robot(self) -> str:
        """Name of the robot, as the cases' names hold it."""

    @property
    @abstractmethod
    def about(self) -> str:
        """What the robot is, in some words for the docs."""

    @abstractmethod
    def fault(self, wrong: Wrong) -> Fault:
        """State what is wrong in the words of the catalogue.

        Args:
            wrong: one of `wrongs`.

        Returns:
            The fault; its values are those over the references, or over the robot's file where
            there are none.
        """

    @abstractmethod
    def material(self, data: Path, duration: float) -> tuple[Material, Truth]:
        """Make the files of the case and its truth.

        Args:
            data: folder of the real logs; none are used.
            duration: of each log [s].

        Returns:
            Files and truth.
        """

    @property
    def seed(self) -> int:
        """Seed that the label gives, the same in every process."""
        return zlib.crc32(self.label.encode()) // 16

    @property
    def identified(self) -> bool:
        """Whether the robot's file is one that its makers identified."""
        return True

    @property
    def truth(self) -> Truth:
        """All that is wrong with the robot of the tests, and with what the case gives."""
        return Truth(
            tuple(self.fault(wrong) for wrong in self.wrongs),
            bool(self.references),
            identified=self.identified,
            everywhere=everywhere(self.wrongs),
        )


class MotionPlan(CasePlan):
    """One case of a robot whose tests and references are logs of one build of it, each of a motion
    of its own.
    """

    @property
    @abstractmethod
    def file(self) -> str:
        """Text of the robot's MJCF file."""

    @abstractmethod
    def log(
        self, wrongs: Sequence[Wrong], motion: str, seed: int, label: str, duration: float
    ) -> Recording:
        """Record one log.

        Args:
            wrongs: what is wrong in it.
            motion: of the robot.
            seed: of the motion and the noise.
            label: name of the log.
            duration: of it [s].

        Returns:
            The log.
        """

    @override
    def material(self, data: Path, duration: float) -> tuple[Material, Truth]:
        def logs(
            wrongs: Sequence[Wrong], motions: Sequence[str], seed: int, label: str
        ) -> tuple[Recording, ...]:
            return tuple(
                self.log(wrongs, motion, seed + 10 * k, f"{label}_{k}", duration).declared(
                    session=label
                )
                for k, motion in enumerate(motions)
            )

        tests = logs(self.wrongs, self.tests, self.seed, "test")
        references = logs((), self.references, self.seed + 100, "healthy")
        return Material(self.file, tests, references), self.truth


P = TypeVar("P", bound=CasePlan)


def single(plan: type[P], label: str, what: str, place: int, size: float, **more: object) -> P:
    """Plan a case with one thing wrong.

    Args:
        plan: class of the robot's plans.
        label: of the case.
        what: is wrong.
        place: number of the joint.
        size: of what is wrong.
        more: fields of the plan.

    Returns:
        The plan.
    """
    return plan(label, (Wrong(what, place, size),), **more)  # type: ignore[arg-type]


def at_all_joints(
    plan: type[P], joints: int, label: str, what: str, size: float, **more: object
) -> P:
    """Plan a case with the same thing wrong at every joint.

    Args:
        plan: class of the robot's plans.
        joints: how many the robot has.
        label: of the case.
        what: is wrong.
        size: of what is wrong at each.
        more: fields of the plan.

    Returns:
        The plan.
    """
    wrongs = tuple(Wrong(what, joint, size) for joint in range(joints))
    return plan(label, wrongs, **more)  # type: ignore[arg-type]


def development_cases(plans: Sequence[CasePlan], duration: float) -> list[Case]:
    """List the cases of a robot whose cases are all for development.

    Args:
        plans: of the cases.
        duration: of each log [s].

    Returns:
        The cases in the same order.
    """
    return [
        Case(
            f"new-{plan.robot}-{plan.label}",
            "newcomers",
            "development",
            f"{plan.about}, {plan.label.replace('-', ' ')}",
            plan.truth.kind,
            partial(plan.material, duration=duration),
        )
        for plan in plans
    ]
