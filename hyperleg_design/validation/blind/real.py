"""Real logs whose truth is known because the metadata are declared wrongly: a gain, a torque
constant, a payload; and healthy ones.

The plant stays real, and what is "wrong" is what the log says of it. Reference logs keep the right
metadata, so that the usual misfit of these small robots is known; test logs are others of the same
robot.

| robot | declared wrongly in the test logs | right answer |
|---|---|---|
| XL330 pendulum | nothing | `none` |
| | firmware gain, half or double | `controller_gain` |
| | torque constant, 25 % off | `torque_constant` |
| | mass on the arm, 0.2 kg off | `payload` |
| SO-101 arm | nothing | `none` |
| | gain of one servo, half or double | `controller_gain` there |
| | a mass in the gripper that is not there | `payload` |
| Go2 in the air | nothing | anything but a long `command_delay` |
"""

from __future__ import annotations

import json
import os
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hyperleg_design import resources
from hyperleg_design.errors import HyperlegError
from hyperleg_design.gap.results.diagnosis import NAMING
from hyperleg_design.validation.blind.trial import FAILED, as_mapping
from hyperleg_design.validation.blind.view import said_of

if TYPE_CHECKING:
    from hyperleg_design.gap.logs.log import Log

DATA = "HYPERLEG_DATA"
"""Environment variable that names the folder of the logs."""
LONG_DELAY = 0.03
"""Delay above which the Go2's soft gains were taken for one [s]."""
XL330_MJCF = """<mujoco model="xl330_pendulum">
  <compiler angle="radian"/>
  <worldbody>
    <body name="stand" pos="0 0 0.5">
      <geom type="box" size="0.01 0.01 0.01" contype="0" conaffinity="0" mass="0"/>
      <body name="arm">
        <inertial pos="0 0 -0.05" mass="0.002" diaginertia="2e-6 2e-6 1e-7"/>
        <joint name="servo" axis="0 1 0"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="servo" joint="servo"/></actuator>
</mujoco>
"""
"""The mass hangs on the arm as a declared payload; friction and rotor are not published with the
logs and are left to the references."""
SO101_JOINTS = (
    "shoulder_pan",
    "shoulder_lift",
    "elbow_flex",
    "wrist_flex",
    "wrist_roll",
    "gripper",
)
"""In the description, in the order of the logs."""
GO2_JOINTS = tuple(
    f"{leg}_{part}_joint" for leg in ("FL", "FR", "RL", "RR") for part in ("hip", "thigh", "calf")
)
GO2_GAINS = (20.0, 1.5)
"""Nominal PD of the Go2's logs [Nm/rad], [Nms/rad]."""


@dataclass(frozen=True, eq=False)
class RealCase:
    """Real logs with metadata of known rightness."""

    name: str
    robot: str
    """File for the diagnosis."""
    logs: tuple[Log, ...]
    references: tuple[Log, ...]
    effect: str
    """Right answer; empty, nothing is wrong; `-`, no answer is known but a wrong one."""
    also: tuple[str, ...] = ()
    """Names that count as the place."""
    parameter: tuple[str, float] | None = None
    """Name and true value of what was declared wrongly."""


@dataclass(frozen=True)
class RealRow:
    """One real case and what was said of it."""

    name: str
    truth: str
    verdict: str
    said: str
    right: bool
    inside: bool | None
    """Whether the stated interval holds the truth."""
    probability: float | None
    seconds: float


@dataclass(frozen=True)
class RealScore:
    """All real cases."""

    rows: tuple[RealRow, ...]
    skipped: tuple[str, ...]
    """What could not be tried, with the reason."""

    def markdown(self) -> str:
        """The table."""
        lines = [
            "| real logs | truth | verdict | said | right | interval holds it | probability | s |",
            "|---|---|---|---|---|---|---|---|",
        ]
        for r in self.rows:
            inside = {True: "yes", False: "no", None: "-"}[r.inside]
            probability = "-" if r.probability is None else f"{r.probability:.2f}"
            lines.append(
                f"| {r.name} | {r.truth} | {r.verdict} | {r.said} | {'yes' if r.right else 'no'} | "
                f"{inside} | {probability} | {r.seconds:.1f} |"
            )
        lines += ["", f"{sum(r.right for r in self.rows)} of {len(self.rows)} right."]
        lines += [f"Skipped: {reason}" for reason in self.skipped]
        return "\n".join(lines) + "\n"


def data_folder() -> Path:
    """Folder of the real logs: what `HYPERLEG_DATA` names, else `../shared/data` beside the
    checkout.
    """
    chosen = os.environ.get(DATA)
    return Path(chosen) if chosen else resources.home().parent / "shared" / "data"


def real_cases(
    folder: str | os.PathLike[str], work: str | os.PathLike[str]
) -> tuple[list[RealCase], list[str]]:
    """Cases from the logs that are there, and reasons for what is not.

    Args:
        folder: of the logs.
        work: for the robot file of the pendulum.
    """
    cases: list[RealCase] = []
    skipped: list[str] = []
    for name, make in (("xl330_pendulum", _xl330), ("so101_arm", _so101), ("go2_air", _go2)):
        place = Path(folder) / name
        if not place.is_dir():
            skipped.append(f"{name}: {place} is absent")
            continue
        try:
            cases += make(place, Path(work))
        except HyperlegError as error:
            skipped.append(f"{name}: {error}")
    return cases, skipped


def score_real(
    folder: str | os.PathLike[str] | None = None,
    *,
    seed: int = 0,
    diagnose: Callable[..., Any] | None = None,
    progress: bool = False,
) -> RealScore:
    """Diagnose every real case and compare.

    Args:
        folder: of the logs; by default `data_folder()`.
        seed: given to every diagnosis.
        diagnose: as in `trial.diagnose_trial`.
        progress: show a bar.
    """
    from tqdm import tqdm

    if diagnose is None:
        from hyperleg_design.gap.pipeline.diagnose import diagnose as own

        diagnose = own
    with tempfile.TemporaryDirectory() as work:
        cases, skipped = real_cases(folder or data_folder(), work)
        rows = []
        for case in tqdm(cases, desc="real logs", disable=not progress, unit=""):
            begun = time.perf_counter()
            try:
                found = as_mapping(
                    diagnose(
                        case.robot, list(case.logs), list(case.references), seed=seed, threads=1
                    )
                )
            except HyperlegError as error:
                found = {"verdict": FAILED, "message": str(error)}
            rows.append(judged(case, found, time.perf_counter() - begun))
    return RealScore(tuple(rows), tuple(skipped))


def judged(case: RealCase, found: Mapping[str, Any], seconds: float) -> RealRow:
    """Whether a diagnosis of a real case is right."""
    verdict = str(found["verdict"])
    named = (
        list(found.get("causes") or []) + list(found.get("rivals") or [])
        if verdict in NAMING
        else []
    )
    first = named[0] if named else None
    inside = None
    if case.effect == "":
        right = verdict == "none"
    elif case.effect == "-":
        late = [
            c
            for c in named
            if c["effect"] == "command_delay"
            and c["parameters"].get("delay", {}).get("value", 0.0) > LONG_DELAY
        ]
        right = verdict != FAILED and not late
    else:
        right = (
            first is not None and first["effect"] == case.effect and first["location"] in case.also
        )
        if right and first is not None and case.parameter is not None:
            stated = first["parameters"].get(case.parameter[0])
            if stated and stated.get("low") is not None and stated.get("high") is not None:
                inside = bool(stated["low"] <= case.parameter[1] <= stated["high"])
    said = said_of(found)
    truth = {"": "nothing wrong", "-": "no long delay"}.get(
        case.effect, f"{case.effect} at {case.also[0] if case.also else ''}"
    )
    probability = first.get("probability") if first else None
    return RealRow(
        case.name,
        truth,
        verdict,
        said,
        right,
        inside,
        None if probability is None else float(probability),
        seconds,
    )


def _declared(
    logs: Sequence[Log],
    role: str,
    change: Callable[[Log], Mapping[str, Any]] | None = None,
    **values: Any,
) -> tuple[Log, ...]:
    """Logs with other metadata."""
    made = []
    for log in logs:
        metadata = log.metadata.changed(role=role, **values)
        made.append(
            replace(
                log,
                metadata=metadata.changed(**change(replace(log, metadata=metadata)))
                if change
                else metadata,
            )
        )
    return tuple(made)


def _xl330(folder: Path, work: Path) -> list[RealCase]:
    from hyperleg_design.gap.logs.readers import open_log

    robot = work / "xl330.xml"
    robot.write_text(XL330_MJCF)
    logs = [log for path in sorted(folder.glob("*.json")) for log in open_log(path)]
    content = json.loads(sorted(folder.glob("*.json"))[0].read_text())
    mass, length = float(content["mass"]), float(content["length"])
    kinds: dict[str, list[Log]] = {}
    for log in logs:
        kinds.setdefault(str(log.metadata.extra.get("trajectory", "")), []).append(log)
    same: dict[str, Any] = {
        "robot": str(robot),
        "base": "fixed",
        "payload": {"arm": (mass, 0.0, 0.0, -length)},
    }
    place, cases = ("servo", "arm"), []

    def gain(factor: float) -> Callable[[Log], Mapping[str, Any]]:
        return lambda log: {
            "gains": {j: (k * factor, d) for j, (k, d) in log.metadata.gains.items()}
        }

    def constant(factor: float) -> Callable[[Log], Mapping[str, Any]]:
        return lambda log: {
            "torque_constant": {m: k * factor for m, k in log.metadata.torque_constant.items()}
        }

    def hung(change: float) -> Callable[[Log], Mapping[str, Any]]:
        return lambda log: {"payload": {"arm": (mass + change, 0.0, 0.0, -length)}}

    for kind in sorted(kinds):
        others = [log for k in sorted(kinds) if k != kind for log in kinds[k]]
        references = _declared(others, "reference", **same)
        for label, change, effect, parameter in (
            ("as it is", None, "", None),
            ("gain declared double", gain(2.0), "controller_gain", ("stiffness_scale", 0.5)),
            ("gain declared half", gain(0.5), "controller_gain", ("stiffness_scale", 2.0)),
            (
                "torque constant declared 25 % high",
                constant(1.25),
                "torque_constant",
                ("scale", 0.8),
            ),
            ("mass declared 0.2 kg light", hung(-0.2), "payload", ("mass", 0.2)),
            ("mass declared 0.2 kg heavy", hung(0.2), "payload", ("mass", -0.2)),
        ):
            tests = _declared(kinds[kind], "test", change, **same)
            cases.append(
                RealCase(
                    f"XL330 {kind}, {label}",
                    str(robot),
                    tests,
                    references,
                    effect,
                    place,
                    parameter,
                )
            )
    return cases


def _so101(folder: Path, work: Path) -> list[RealCase]:
    from hyperleg_design.gap.logs.readers import open_log
    from hyperleg_design.sizing.other_robots import robots_folder

    robot = robots_folder() / "so_arm_description" / "urdf" / "so101.urdf"
    logs = {
        p.name: open_log(p, metadata={"joints": list(SO101_JOINTS)})[0]
        for p in sorted(folder.iterdir())
        if p.is_dir()
    }
    same: dict[str, Any] = {"robot": str(robot), "base": "fixed"}
    references = _declared(
        [log for name, log in logs.items() if name in ("chirp_sweep", "friction_gravity")],
        "reference",
        **same,
    )
    own = [log for name, log in logs.items() if name in ("step_response", "triangle_wave")]

    def gain(joint: str, factor: float) -> Callable[[Log], Mapping[str, Any]]:
        return lambda log: {
            "gains": {
                j: (k * (factor if j == joint else 1.0), d)
                for j, (k, d) in log.metadata.gains.items()
            }
        }

    def held(mass: float) -> Callable[[Log], Mapping[str, Any]]:
        return lambda log: {"payload": {"gripper_link": (mass, 0.0, 0.0, -0.05)}}

    cases = []
    for label, change, effect, also, parameter in (
        ("as it is", None, "", (), None),
        (
            "gain of shoulder_lift declared double",
            gain("shoulder_lift", 2.0),
            "controller_gain",
            ("shoulder_lift",),
            ("stiffness_scale", 0.5),
        ),
        (
            "gain of elbow_flex declared half",
            gain("elbow_flex", 0.5),
            "controller_gain",
            ("elbow_flex",),
            ("stiffness_scale", 2.0),
        ),
        (
            "0.3 kg declared that is not there",
            held(0.3),
            "payload",
            ("gripper_link", "wrist_roll", "moving_jaw_so101_v1_link", "gripper"),
            ("mass", -0.3),
        ),
    ):
        cases.append(
            RealCase(
                f"SO-101, {label}",
                str(robot),
                _declared(own, "test", change, **same),
                references,
                effect,
                also,
                parameter,
            )
        )
    return cases


def _go2(folder: Path, work: Path) -> list[RealCase]:
    from hyperleg_design.gap.logs.readers import open_log
    from hyperleg_design.sizing.other_robots import robots_folder

    robot = robots_folder() / "go2_description" / "urdf" / "go2.urdf"
    logs = open_log(folder / "traj_0.pt", metadata={"joints": list(GO2_JOINTS)})
    gains = dict.fromkeys(GO2_JOINTS, GO2_GAINS)
    tests = _declared(logs, "test", robot=str(robot), base="fixed", gains=gains)
    return [RealCase("Go2 in the air, as it is", str(robot), tests, (), "-")]
