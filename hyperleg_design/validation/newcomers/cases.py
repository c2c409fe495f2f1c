"""The newcomers' cases: what is wrong with which robot, and the truth that follows."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import mujoco

from hyperleg_design.validation.benchmark.case import Case, Fault, Material, Recording, Truth
from hyperleg_design.validation.newcomers.names import EFFECTS, fault_of
from hyperleg_design.validation.newcomers.plant import Wrong, built, simulate
from hyperleg_design.validation.newcomers.robots import ROBOTS, Robot

CHANNELS = {
    "all": (),
    "torques": ("motor_torque_command",),
    "targets": ("motor_torque_command", "motor_torque"),
}
"""Signals that are left out, by the name of a set of channels."""


@dataclass(frozen=True)
class Plan:
    """One case of a newcomer's robot."""

    robot: str
    label: str
    wrongs: tuple[Wrong, ...] = ()
    everywhere: bool = False
    channels: str = "all"
    references: bool = True
    fault_places: tuple[str, ...] = ()
    """Names of the place of a load."""
    seed: int = 0
    """Tells cases that are otherwise the same from one another."""

    @property
    def name(self) -> str:
        """Name of the case, from robot, label, channels, references and seed."""
        parts = ["new", self.robot, self.label, self.channels]
        parts += ["referenced" if self.references else "alone"]
        return "-".join([*parts, *([str(self.seed)] if self.seed else [])]).replace(" ", "_")

    @property
    def kind(self) -> str:
        """Which of `benchmark.case.KINDS` the case is, by its faults."""
        if not self.wrongs:
            return "nothing"
        if any(wrong.what not in EFFECTS for wrong in self.wrongs):
            return "outside"
        if self.everywhere:
            return "everywhere"
        return "single" if len(self.wrongs) == 1 else "several"


def _one(robot: str, what: str, place: int = 0, size: float = 0.0, **more: object) -> Plan:
    return Plan(robot, what, (Wrong(what, place, size),), **more)  # type: ignore[arg-type]


def _load(robot: str, mass: float, body: str, joint: str, at: tuple[float, float, float]) -> Plan:
    wrong = Wrong("load", size=mass, body=body, at=at)
    return Plan(robot, f"load_{body}", (wrong,), fault_places=(body, joint))


def _each(robot: str, what: str, size: float, joints: int, **more: object) -> Plan:
    wrongs = tuple(Wrong(what, j, size) for j in range(joints))
    return Plan(robot, f"{what}_everywhere", wrongs, everywhere=True, **more)  # type: ignore[arg-type]


def _tired(references: bool, seed: int, channels: str = "all") -> Plan:
    """Coulomb and viscous friction three times as large at both joints of the two-link arm."""
    wrongs = tuple(Wrong(what, j, 3.0) for what in ("rough", "thick") for j in (0, 1))
    label = "rough_thick_everywhere"
    return Plan("two_link", label, wrongs, True, channels, references, seed=seed)


PLANS: tuple[Plan, ...] = (
    Plan("two_link", "nothing"),
    Plan("two_link", "nothing", references=False),
    Plan("two_link", "nothing", channels="torques"),
    _tired(True, 1),
    _tired(True, 2),
    _tired(False, 1),
    _tired(False, 2, "torques"),
    _each("two_link", "rough", 3.0, 2),
    _each("two_link", "thick", 3.0, 2, references=False),
    _each("two_link", "weak", 0.8, 2),
    _one("two_link", "weak", 1, 0.8, references=False),
    _one("two_link", "zero", 1, 0.06),
    _one("two_link", "lag", 0, 0.012),
    _load("two_link", 0.4, "lower", "elbow", (0, 0, -0.3)),
    Plan("two_link", "dry_late", (Wrong("dry", 0, 0.6), Wrong("late", size=0.01))),
    Plan("two_link", "zero_weak", (Wrong("zero", 1, 0.06), Wrong("weak", 0, 0.8))),
    _one("two_link", "drag", 0, 0.4),
    _one("two_link", "hysteresis", 0, 1.2),
    Plan("dog_leg", "nothing", channels="torques"),
    Plan("dog_leg", "nothing", references=False),
    _each("dog_leg", "rough", 3.0, 3, channels="torques"),
    _one("dog_leg", "weak", 2, 0.8, channels="torques"),
    _one("dog_leg", "zero", 1, 0.06, channels="targets"),
    _one("dog_leg", "late", size=0.01),
    _load("dog_leg", 0.25, "calf", "knee", (0, 0, -0.2)),
    Plan("dog_leg", "zero_dry", (Wrong("zero", 1, 0.06), Wrong("dry", 2, 0.6))),
    _one("dog_leg", "patch", 2, 1.2),
    Plan("six", "nothing"),
    Plan("six", "nothing", channels="torques"),
    _one("six", "dry", 1, 6.0),
    _one("six", "thick", 2, 3.0),
    _one("six", "weak", 2, 0.85),
    _one("six", "zero", 1, 0.05),
    _one("six", "late", size=0.01),
    _load("six", 1.2, "six", "j6", (0.02, 0.1, 0)),
    _each("six", "rough", 3.0, 6),
    Plan("six", "zero_dry", (Wrong("zero", 2, 0.05), Wrong("dry", 1, 6.0))),
    _one("six", "patch", 1, 8.0),
    _one("six", "push", 2, 8.0),
    Plan("arm", "nothing"),
    Plan("leg", "nothing"),
    Plan("coupled", "nothing"),
    Plan("arm", "nothing", references=False),
    _load("arm", 0.8, "hand", "wrist", (0, 0, 0.1)),
    _load("arm", 0.6, "fore", "elbow", (0, 0, 0.2)),
    _one("arm", "dry", 2, 1.2),
    _one("arm", "viscous", 1, 2.0),
    _one("arm", "weak", 1, 0.85),
    _one("arm", "late", size=0.01),
    _one("arm", "zero", 1, 0.06),
    _one("arm", "gain", 2, 0.7),
    _one("arm", "rotor", 1, 0.25),
    _one("arm", "spring", 2, 5.0),
    _one("arm", "breakaway", 1, 2.0),
    _one("arm", "limit", 1, 8.0),
    _load("leg", 0.8, "foot", "ankle", (0.03, 0, -0.04)),
    _one("leg", "dry", 2, 2.0),
    _one("leg", "viscous", 3, 0.6),
    _one("leg", "weak", 2, 0.8),
    _one("leg", "late", size=0.01),
    _one("leg", "zero", 1, 0.06),
    _one("leg", "gain", 3, 0.6),
    _one("leg", "rotor", 2, 0.3),
    _one("leg", "lossy", 1, 0.2),
    _one("coupled", "weak", 2, 0.8),
    _one("coupled", "dry", 3, 1.2),
    _load("coupled", 0.8, "foot", "ankle", (0.03, 0, -0.04)),
    _one("coupled", "limit", 2, 1.0),
    _one("coupled", "late", size=0.01),
    _one("coupled", "zero", 3, 0.06),
    _one("arm", "tilt", size=0.1),
    _one("arm", "drag", 1, 1.5),
    _one("arm", "hysteresis", 1, 3.0),
    _one("arm", "push", 2, 3.0),
    _one("arm", "patch", 1, 3.0),
    _one("arm", "lost commands", size=0.3),
    _one("arm", "ripple", 1, 0.25),
    _one("leg", "hysteresis", 2, 3.0),
    _one("leg", "patch", 2, 3.0),
    _one("coupled", "hysteresis", 2, 3.0),
    _one("coupled", "ripple", 3, 0.3),
    _one("arm", "soft", 1, 12.0),
    _one("arm", "play", 2, 0.03),
    _one("leg", "soft", 2, 14.0),
    _one("leg", "play", 1, 0.02),
)
"""In this order. Robots of the development split were looked at while the diagnosis was made."""
DEVELOPMENT = ("arm", "leg", "coupled", "two_link")
"""Robots whose cases are for development; those on the others are held out."""


def newcomer_cases() -> list[Case]:
    """List all cases of these robots."""
    return [
        Case(
            plan.name,
            "newcomers",
            "development" if plan.robot in DEVELOPMENT else "held out",
            f"{plan.robot}, {plan.label.replace('_', ' ')}, {plan.channels} of the channels, "
            f"{'two' if plan.references else 'no'} references",
            plan.kind,
            partial(material, plan=plan),
        )
        for plan in PLANS
    ]


def material(data: Path, plan: Plan) -> tuple[Material, Truth]:
    """The files of one case and its truth.

    Args:
        data: of the real logs; none are used.
        plan: of the case.
    """
    robot = ROBOTS[plan.robot]
    seed = zlib.crc32(plan.name.encode()) // 16
    out = CHANNELS[plan.channels]

    def logs(wrongs: tuple[Wrong, ...], numbers: tuple[int, ...], label: str) -> list[Recording]:
        return [
            simulate(robot, wrongs, seed + 10 * k, seed, f"{label}_{k}")
            .declared(session=label)
            .without(*out)
            for k in numbers
        ]

    tests = logs(plan.wrongs, (0, 1), "test")
    references = logs((), (2, 3), "healthy") if plan.references else []
    faults = tuple(_fault(plan, robot, wrong, seed) for wrong in plan.wrongs)
    truth = Truth(_merged(faults), plan.references, everywhere=plan.everywhere)
    return Material(robot.xml, tuple(tests), tuple(references)), truth


def _fault(plan: Plan, robot: Robot, wrong: Wrong, build: int) -> Fault:
    """What is wrong in the words of the catalogue."""
    model = mujoco.MjModel.from_xml_string(robot.xml)
    joint, motor = model.joint(wrong.place).name, model.actuator(wrong.place).name
    of_motor = wrong.what in ("weak", "limit", "rotor", "soft", "play", "lag")
    coupled = model.ntendon > 0 and wrong.place >= 2
    places: tuple[str, ...] = (motor,) if of_motor and coupled else (joint, motor)
    if wrong.what == "load":
        places = plan.fault_places
    values = None
    if wrong.what in ("rough", "thick"):
        values = _excess(model, robot, wrong, build, plan.references)
    if wrong.what == "rotor" and not coupled and float(model.actuator_gear[wrong.place, 0]) == 1:
        values = {"inertia": wrong.size}
    return fault_of(wrong.what, places, wrong.size, values)


def _excess(
    model: mujoco.MjModel, robot: Robot, wrong: Wrong, build: int, references: bool
) -> dict[str, float]:
    """Friction over what references show, or over what the file says where there are none."""
    built_model, _ = built(robot, build)
    name = "torque" if wrong.what == "rough" else "damping"
    actual, declared = (
        (m.dof_frictionloss if name == "torque" else m.dof_damping)[wrong.place]
        for m in (built_model, model)
    )
    return {name: float(wrong.size * actual - (actual if references else declared))}


def _merged(faults: tuple[Fault, ...]) -> tuple[Fault, ...]:
    """Faults, with Coulomb and viscous friction of one joint, where both act, as one: either name
    is right.
    """
    merged: dict[tuple[str, ...], Fault] = {}
    others = []
    for fault in faults:
        if fault.effect not in ("coulomb_friction", "viscous_friction") or len(faults) < 4:
            others.append(fault)
        elif fault.places in merged:
            first = merged[fault.places]
            alike = (*first.equivalents, (fault.effect, fault.places))
            merged[fault.places] = Fault(first.effect, first.places, {}, alike)
        else:
            merged[fault.places] = fault
    return (*others, *merged.values())
