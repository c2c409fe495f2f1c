"""Recordings of the double pendulum A.0 (DFKI, `double_pendulum_a0/`) as logs, and its cases.

Torques of its files are those at the joints. `tau_con` holds the friction compensation: for the
joint without a motor in the swing-ups it equals `tau_fric`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from hyperleg_design.errors import InputError
from hyperleg_design.validation.benchmark.case import Case, Fault, Material, Recording, Truth
from hyperleg_design.validation.real.a0_model import JOINTS, TIP_MASS, DoublePendulum, read_model

FOLDER = "double_pendulum_a0"
MODEL = "model_2.0.yml"
WINDOWS = {"swing_up/pendubot_1": (0.0, 4.0), "swing_up/pendubot_2": (0.0, 4.0)}
"""Part of a recording that is used [s]: the swing-up without the balancing after it, whose
controller flips between its limits from tick to tick."""
COMMAND, MEASURED, VELOCITY = "motor_torque_command", "motor_torque", "velocity"
CHANNELS = {
    "full": (),
    "measured": (COMMAND,),
    "command": (MEASURED,),
    "positions": (COMMAND, VELOCITY),
}
"""Signals that are left out, by the name of a set of channels."""
COMPENSATION = {"compensation_untold": -1.0, "compensation_twice": 1.0}
"""Of the friction compensation that the tests' commands already hold, how much is added."""
ENCODER = 0.08
"""Added to the readings of an encoder [rad]."""
TIP_PLACES = ("lower", "elbow")
WEAK = ("transmission_ratio", "controller_gain")
"""What logs without rotor speeds and without targets cannot tell from a torque constant."""


@dataclass(frozen=True)
class Declared:
    """A fault by a wrong declaration: the model of the robot, changed, and the tests, changed."""

    truth: tuple[Fault, ...]
    model: Callable[[DoublePendulum], DoublePendulum] = lambda model: model
    test: Callable[[Recording], Recording] = lambda log: log
    reference: Callable[[Recording], Recording] = lambda log: log


def read_recording(folder: Path, name: str) -> Recording:
    """One of the makers' CSV files as a log.

    Ticks whose clock does not advance are left out.

    Args:
        folder: of the robot's files.
        name: `GROUP/FILE` without `.csv`.

    Raises:
        InputError: unreadable, or a column is missing.
    """
    path = folder / f"{name}.csv"
    try:
        table = pd.read_csv(path, skipinitialspace=True)
    except (OSError, ValueError) as error:
        raise InputError(name, "", None, f"cannot be read as CSV ({error})") from None
    own = "tau_con1" in table.columns
    names = {"position": "pos_meas", "velocity": "vel_meas", COMMAND: "tau_con"} if own else {}
    names |= {MEASURED: "tau_meas"} if own else {}
    names = names or {"position": "pos", "velocity": "vel", COMMAND: "tau"}
    missing = [f"{c}{k}" for c in names.values() for k in (1, 2) if f"{c}{k}" not in table.columns]
    if "time" not in table.columns or missing:
        raise InputError(name, "time" if not missing else missing[0], None, "is missing")
    clock = table["time"].to_numpy(float)
    rising = np.r_[True, np.diff(np.maximum.accumulate(clock)) > 0]
    signals = {
        f"{kind}/{joint}": table[f"{column}{k + 1}"].to_numpy(float)[rising]
        for kind, column in names.items()
        for k, joint in enumerate(JOINTS)
    }
    short = name.split("/")[1]
    recording = Recording(short, clock[rising], signals, {"base": "fixed", "session": name})
    begin, end = WINDOWS.get(name, (0.0, np.inf))
    return recording.part(begin, end)


def compensation(folder: Path, name: str) -> np.ndarray:
    """The torque of the friction compensation `tau_fric` in a recording of the makers, at the ticks
    of `read_recording` `(t, 2)` [Nm].

    Args:
        folder: of the recordings.
        name: of the recording.

    Returns:
        The torque `(t, 2)` [Nm].
    """
    table = pd.read_csv(folder / f"{name}.csv", skipinitialspace=True)
    clock = table["time"].to_numpy(float)
    recording = read_recording(folder, name)
    columns = [np.interp(recording.time, clock, table[f"tau_fric{k}"]) for k in (1, 2)]
    return np.stack(columns, 1)


def material(
    data: Path, tests: tuple[str, ...], references: tuple[str, ...], channels: str, fault: str
) -> tuple[Material, Truth]:
    """The files of one case and its truth.

    Args:
        data: folder of the real logs.
        tests: names of the recordings to be diagnosed.
        references: names of those of the robot as it is.
        channels: a key of `CHANNELS`.
        fault: a key of `faults`.
    """
    folder = data / FOLDER
    nominal = read_model(folder / MODEL)
    declared = faults(nominal)[fault]
    left_out = CHANNELS[channels]

    def read(name: str, change: Callable[[Recording], Recording]) -> Recording:
        log = read_recording(folder, name)
        if fault in COMPENSATION:
            log = _compensated(log, compensation(folder, name), fault, name in tests)
        return change(log).without(*left_out)

    truth = Truth(
        declared.truth,
        references=bool(references),
        identified=not fault.startswith("standing"),
        everywhere=len(declared.truth) > 1,
    )
    files = Material(
        declared.model(nominal).mjcf(),
        tuple(read(name, declared.test) for name in tests),
        tuple(read(name, declared.reference) for name in references),
    )
    return files, truth


def _compensated(log: Recording, torque: np.ndarray, fault: str, test: bool) -> Recording:
    sign = COMPENSATION[fault] if test else 0.0
    columns = {
        f"{COMMAND}/{joint}": log.signals[f"{COMMAND}/{joint}"] + sign * torque[:, k]
        for k, joint in enumerate(JOINTS)
    }
    return Recording(log.name, log.time, {**log.signals, **columns}, log.metadata)


def faults(model: DoublePendulum) -> dict[str, Declared]:
    """All wrong declarations of this robot by name, with the truth that follows from the model.

    Args:
        model: of the robot.

    Returns:
        The declarations by name.
    """
    declarations = {"nothing": Declared(())}
    for k, joint in enumerate(JOINTS):
        places = (joint,)
        columns = (f"{COMMAND}/{joint}", f"{MEASURED}/{joint}")
        for label, factor in (("low", 0.75), ("high", 4 / 3)):
            fault = Fault(
                "torque_constant",
                places,
                {"scale": 1 / factor},
                tuple((effect, places) for effect in WEAK),
            )
            scale = partial(_scaled, factor=factor, columns=columns)
            declarations[f"torque_{label}_{joint}"] = Declared((fault,), test=scale)
        shift = partial(_shifted, column=f"position/{joint}")
        offset = Fault("encoder_offset", places, {"offset": ENCODER})
        declarations[f"encoder_{joint}"] = Declared((offset,), test=shift)
        declarations[f"friction_{joint}"] = Declared(
            (_friction(joint, model.coulomb[k]),), partial(_frictionless, joints=places)
        )
    both = tuple(_friction(joint, model.coulomb[k]) for k, joint in enumerate(JOINTS))
    declarations["friction_both"] = Declared(both, partial(_frictionless, joints=JOINTS))
    declarations["standing_friction_both"] = Declared((), partial(_frictionless, joints=JOINTS))
    declarations["standing_rotors"] = Declared((), DoublePendulum.without_rotors)
    tip = {"payload": {"lower": [TIP_MASS, 0.0, 0.0, -model.length[1]]}}

    def with_tip(log: Recording) -> Recording:
        return log.declared(**tip)

    declarations["tip_missing"] = Declared(
        (_payload(TIP_MASS),), DoublePendulum.without_tip, reference=with_tip
    )
    declarations["tip_twice"] = Declared((_payload(-TIP_MASS),), test=with_tip)
    rotors = tuple(
        Fault("rotor_inertia", (joint,), {"inertia": model.armature[k]})
        for k, joint in enumerate(JOINTS)
    )
    declarations["rotors"] = Declared(rotors, DoublePendulum.without_rotors)
    for milliseconds in (10, 20):
        seconds = milliseconds / 1e3
        late = Fault("command_delay", ("robot",), {"delay": seconds})
        declarations[f"delay_{milliseconds}ms"] = Declared(
            (late,), test=partial(_early, seconds=seconds)
        )
    gone = tuple(Fault("coulomb_friction", (j,), {}, _like_friction(j)) for j in JOINTS)
    declarations |= {name: Declared(gone) for name in COMPENSATION}
    return declarations


def _like_friction(joint: str) -> tuple[tuple[str, tuple[str, ...]], ...]:
    return tuple((e, (joint,)) for e in ("stribeck_friction", "viscous_friction"))


def _friction(joint: str, torque: float) -> Fault:
    return Fault("coulomb_friction", (joint,), {"torque": torque}, _like_friction(joint)[:1])


def _payload(mass: float) -> Fault:
    return Fault("payload", TIP_PLACES, {"mass": mass}, (("link_mass", TIP_PLACES),))


def _scaled(log: Recording, factor: float, columns: tuple[str, ...]) -> Recording:
    return log.scaled(factor, *columns)


def _shifted(log: Recording, column: str) -> Recording:
    return log.shifted(ENCODER, column)


def _early(log: Recording, seconds: float) -> Recording:
    return log.early(seconds, COMMAND)


def _frictionless(model: DoublePendulum, joints: tuple[str, ...]) -> DoublePendulum:
    return model.without_friction(*joints)


def _day(*numbers: int) -> tuple[str, ...]:
    return tuple(f"sys_id/trajectory_{number:02d}" for number in numbers)


def _other_day(*times: str) -> tuple[str, ...]:
    return tuple(f"sys_id_2/{time}" for time in times)


FIRST, SECOND, DAY = _day(0, 3), _day(1, 5), _day(2, 4, 12)
"""Tests and references of the development cases."""
FAST, SLOW = _other_day("060143"), _other_day("055640")
FAST_DAY, SLOW_DAY = _other_day("060245", "055032"), _other_day("055032", "055903")
SWING, OTHER_SWING = ("swing_up/pendubot_1",), ("swing_up/pendubot_2",)
COMPENSATED, CHIRP = ("friction_compensation/sys_id_on",), _day(11)
NONE: tuple[str, ...] = ()
PLAN: tuple[tuple[str, tuple[str, ...], tuple[str, ...], str], ...] = (
    ("nothing", FIRST, DAY, "full"),
    ("nothing", FIRST, NONE, "full"),
    ("nothing", FIRST, DAY, "command"),
    ("nothing", SECOND, DAY, "measured"),
    ("nothing", SECOND, NONE, "measured"),
    ("nothing", SECOND, DAY, "positions"),
    ("standing_friction_both", FIRST, DAY, "full"),
    ("standing_rotors", SECOND, DAY, "measured"),
    ("torque_high_elbow", FIRST, DAY, "full"),
    ("torque_low_elbow", SECOND, NONE, "measured"),
    ("torque_low_shoulder", FIRST, DAY, "command"),
    ("torque_high_shoulder", SECOND, DAY, "full"),
    ("encoder_elbow", FIRST, DAY, "full"),
    ("encoder_elbow", SECOND, NONE, "command"),
    ("encoder_shoulder", SECOND, DAY, "measured"),
    ("friction_elbow", FIRST, NONE, "full"),
    ("friction_shoulder", SECOND, NONE, "measured"),
    ("friction_both", FIRST, NONE, "command"),
    ("tip_missing", FIRST, NONE, "full"),
    ("tip_missing", SECOND, DAY, "measured"),
    ("tip_twice", SECOND, NONE, "full"),
    ("tip_twice", FIRST, DAY, "command"),
    ("rotors", FIRST, NONE, "measured"),
    ("delay_20ms", FIRST, DAY, "full"),
    ("delay_10ms", SECOND, NONE, "full"),
    ("delay_20ms", SECOND, NONE, "command"),
    ("nothing", FAST, FAST_DAY, "command"),
    ("nothing", FAST, NONE, "command"),
    ("nothing", SLOW, SLOW_DAY, "command"),
    ("nothing", CHIRP, DAY, "full"),
    ("nothing", CHIRP, NONE, "measured"),
    ("nothing", SWING, OTHER_SWING, "full"),
    ("nothing", OTHER_SWING, NONE, "measured"),
    ("nothing", COMPENSATED, NONE, "command"),
    ("standing_friction_both", FAST, FAST_DAY, "command"),
    ("torque_high_shoulder", FAST, FAST_DAY, "command"),
    ("torque_low_shoulder", FAST, NONE, "command"),
    ("torque_high_elbow", SLOW, SLOW_DAY, "command"),
    ("torque_low_elbow", CHIRP, DAY, "measured"),
    ("encoder_elbow", FAST, NONE, "command"),
    ("encoder_shoulder", FAST, FAST_DAY, "command"),
    ("encoder_elbow", SWING, OTHER_SWING, "full"),
    ("friction_both", FAST, NONE, "command"),
    ("friction_elbow", SLOW, NONE, "command"),
    ("tip_missing", FAST, FAST_DAY, "command"),
    ("tip_missing", FAST, NONE, "command"),
    ("tip_twice", FAST, FAST_DAY, "command"),
    ("rotors", FAST, NONE, "command"),
    ("delay_20ms", FAST, FAST_DAY, "command"),
    ("delay_10ms", CHIRP, DAY, "full"),
    ("compensation_untold", SWING, OTHER_SWING, "command"),
    ("compensation_twice", OTHER_SWING, NONE, "command"),
)
"""Fault, tests, references and channels of each case."""
DEVELOPMENT = {*FIRST, *SECOND, *DAY}
"""Recordings whose cases are for development; tests on all others are held out."""


def a0_cases() -> list[Case]:
    """All cases of this robot, in the order of `PLAN`."""
    cases = []
    for fault, tests, references, channels in PLAN:
        healthy = fault == "nothing" or fault.startswith("standing")
        joint = fault.endswith(("_both", "rotors", "untold", "twice")) and fault != "tip_twice"
        label = tests[0].split("/")[-1].replace("trajectory_", "")
        given = "referenced" if references else "alone"
        cases.append(
            Case(
                f"a0-{fault}-{label}-{channels}-{given}",
                "real",
                "development" if set(tests) <= DEVELOPMENT else "held out",
                f"double pendulum A.0, {fault.replace('_', ' ')}, {' and '.join(tests)}, "
                f"{channels} channels, {len(references)} references",
                "nothing" if healthy else "everywhere" if joint else "single",
                partial(
                    material, tests=tests, references=references, channels=channels, fault=fault
                ),
                needs=FOLDER,
            )
        )
    return cases
