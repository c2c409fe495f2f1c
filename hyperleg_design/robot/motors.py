"""The motor catalogue: the shipped motors and those of the user, and arrays of their constants."""

from __future__ import annotations

import os
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.memoized import memoized
from hyperleg_design.robot.motor import Constant, Motor, load_motor
from hyperleg_design.robot.names import ACTUATOR_OF_MOTOR, MOTORS
from hyperleg_design.robot.parameters import values as parameters

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.robot.parameters.hyperleg import HyperLeg

FOLDERS = "HYPERLEG_MOTORS"
"""Environment variable with folders of motors beside the shipped ones, separated like `PATH`."""


@dataclass(frozen=True, eq=False)
class MotorArrays:
    """Constants of the motors of one limb, batched; every array is `(..., motors)`, HyperLeg's in
    the order of `MOTORS`.
    """

    no_load_speed: np.ndarray
    """No-load speed at the design's bus voltage [rad/s]."""
    stall_torque: np.ndarray
    """Stall torque at the design's bus voltage [Nm]."""
    peak_torque: np.ndarray
    """Peak torque [Nm]."""
    rated_torque: np.ndarray
    """Continuous torque [Nm]."""
    power_constant: np.ndarray
    """Winding heat over squared torque [W/Nm^2]."""
    rotor_inertia: np.ndarray
    """Inertia of the rotor [kg m^2]."""
    mass: np.ndarray
    """Mass of the bare motor [kg]."""

    @property
    def standstill_torque(self) -> np.ndarray:
        """Largest torque at standstill [Nm], `(..., motors)`: the peak torque, or the stall torque
        where the design's bus voltage allows no more.
        """
        return np.minimum(self.peak_torque, self.stall_torque)


@cache
def _catalogue_at(folder: Path) -> dict[str, Motor]:
    return {path.stem: load_motor(path) for path in sorted(folder.glob("*.yaml"))}


def catalogue() -> dict[str, Motor]:
    """All motors by name: those that are shipped, and those of the user's own folders
    (`use_folder`).

    Returns:
        Motors by name, in the order of the alphabet.

    Raises:
        InputError: a folder of the user's that is not there, a file in it that is no motor, or one
            with the name of another motor.
    """
    return _joined(resources.content_folder("motors"), os.environ.get(FOLDERS, ""))


@cache
def _joined(shipped: Path, folders: str) -> dict[str, Motor]:
    motors = dict(_catalogue_at(shipped))
    named = {Path(text).resolve(): text for text in filter(None, folders.split(os.pathsep))}
    for folder, text in named.items():
        if not folder.is_dir():
            raise InputError("--motors", "", text, "is no folder; expects one with motor files")
        own = _catalogue_at(folder)
        if not own:
            raise InputError("--motors", "", text, "holds no motor files (NAME.yaml)")
        for name in own:
            if name in motors:
                remedy = "is the name of another motor; rename the file"
                raise InputError("--motors", "", str(folder / f"{name}.yaml"), remedy)
        motors |= own
    return motors


def use_folder(folder: str | Path) -> None:
    """Add the motors of a folder to the catalogue of this process and of those that it starts.

    Args:
        folder: with one YAML file for each motor.

    Raises:
        InputError: as `catalogue`.
    """
    given = [text for text in os.environ.get(FOLDERS, "").split(os.pathsep) if text]
    before = os.environ.get(FOLDERS)
    text = str(Path(folder).resolve())
    os.environ[FOLDERS] = os.pathsep.join([*given, *([] if text in given else [text])])
    try:
        catalogue()
    except InputError:
        if before is None:
            del os.environ[FOLDERS]
        else:
            os.environ[FOLDERS] = before
        raise


def folder_option() -> str:
    """Write the folder that `use_folder` added last as an option of the command line.

    Returns:
        ` --motors FOLDER`, or nothing where only shipped motors are known.
    """
    folder = os.environ.get(FOLDERS, "").split(os.pathsep)[-1]
    return f" --motors {shlex.quote(folder)}" if folder else ""


def own_file(name: str) -> Path | None:
    """Find the file of a motor that is not shipped.

    Args:
        name: of the motor, or the path of its file.

    Returns:
        The path; None for a shipped motor.
    """
    if name.endswith(".yaml"):
        return Path(name)
    folders = filter(None, os.environ.get(FOLDERS, "").split(os.pathsep))
    files = (Path(folder) / f"{name}.yaml" for folder in folders)
    return next((file for file in files if file.is_file()), None)


def find_motor(name: str, where: str = "motors", field: str = "") -> Motor:
    """A motor by name, or of a file `PATH/NAME.yaml`.

    Args:
        name: of the motor, such as `RI70`, or the path of its file.
        where: file or option that names the motor, for the error.
        field: dotted path of the field in it, for the error.

    Returns:
        The motor.

    Raises:
        InputError: there is none; names the nearest.
    """
    if name.endswith(".yaml"):
        return _of_file(name, where, field)
    motors = catalogue()
    if name not in motors:
        raise InputError(
            where,
            field,
            name,
            f"{parameters.unknown(name, sorted(motors), 'motor')}; --motors FOLDER adds your own",
        )
    return motors[name]


def _of_file(name: str, where: str, field: str) -> Motor:
    path = Path(name)
    if not path.is_file():
        raise InputError(where, field, name, "no such motor file; give a path that exists")
    return _motor_at(path, path.resolve(), path.stat().st_mtime_ns)


@cache
def _motor_at(path: Path, place: Path, written: int) -> Motor:
    """The motor of a file; errors name the path as it was given."""
    return load_motor(path)


def check_names(design: HyperLeg, where: str) -> None:
    """Check that all motors that a design names are in the catalogue.

    Args:
        design: a robot or batch.
        where: file, for error messages.

    Raises:
        InputError: one is not.
    """
    for actuator in dict.fromkeys(ACTUATOR_OF_MOTOR):
        for name in np.unique(getattr(design.actuators, actuator).motor):
            find_motor(str(name), where, f"actuators.{actuator}.motor")
    for part in ("hip", "knee", "ankle", "toe"):
        find_motor(
            str(getattr(design.reference, f"{part}_motor")), where, f"reference.{part}_motor"
        )


def gather(names: Any, value: Any) -> np.ndarray:
    """Collect a number of one or several motors.

    Args:
        names: one name, or an array of names, `(...)`.
        value: function from a `Motor` to the number.

    Returns:
        The numbers, `(...)`.
    """
    if isinstance(names, str):
        return np.asarray(value(find_motor(names)), float)
    unique, inverse = np.unique(np.asarray(names), return_inverse=True)
    return np.array([value(find_motor(str(n))) for n in unique], float)[inverse].reshape(
        np.shape(names)
    )


def motor_arrays(design: RobotDesign) -> MotorArrays:
    """Collect the constants of the motors of one limb.

    They are computed once for each design, as long as its names mean the same motors.

    Args:
        design: a robot or batch.

    Returns:
        Constants, each `(..., motors)`, not to be written into; for HyperLeg of all seven motors,
        whether that of the toe is installed or not.

    Raises:
        InputError: the kind of constants differs within a batch, or a motor is not in the
            catalogue.
    """
    electrical = design.electrical_section
    kind = electrical.constants
    if isinstance(kind, np.ndarray):
        raise InputError(
            design.name, "electrical.constants", kind.tolist(), "cannot differ within a batch"
        )
    named = motors_by_name([actuator.motor for actuator in design.every_actuator])
    return _arrays(design, tuple(named.items()))


def motors_by_name(names: Sequence[Any]) -> dict[str, Motor]:
    """Look up motors by their names.

    Args:
        names: of each motor of a robot one name, or an array of names.

    Returns:
        The motors by name, each once.

    Raises:
        InputError: one is not in the catalogue.
    """
    if all(isinstance(name, str) for name in names):
        return {name: find_motor(name) for name in dict.fromkeys(names)}
    unique = np.unique(np.concatenate([np.ravel(name) for name in names]))
    return {str(name): find_motor(str(name)) for name in unique}


@memoized
def _arrays(design: RobotDesign, motors: tuple[tuple[str, Motor], ...]) -> MotorArrays:
    """Constants of the motors of one limb, whose names mean these motors."""
    names_of = [actuator.motor for actuator in design.every_actuator]
    batch, kind = design.batch_shape, design.electrical_section.constants
    ratio = np.asarray(design.electrical_section.voltage_ratio, float)
    voltage = np.broadcast_to(ratio, batch)[..., None]

    def stacked(value: Any) -> np.ndarray:
        numbers = {name: value(motor) for name, motor in motors}
        columns = [
            np.broadcast_to([numbers[str(name)] for name in np.ravel(names)], batch or (1,))
            for names in names_of
        ]
        return np.stack(columns, -1).astype(float).reshape(*batch, len(names_of))

    arrays = MotorArrays(
        no_load_speed=stacked(lambda m: m.no_load_speed(kind)) * voltage,
        stall_torque=stacked(lambda m: m.stall_torque(kind)) * voltage,
        peak_torque=stacked(lambda m: m.peak_torque(kind)),
        rated_torque=stacked(lambda m: m.rated_torque),
        power_constant=stacked(lambda m: m.power_constant(kind)),
        rotor_inertia=stacked(lambda m: m.rotor_inertia),
        mass=stacked(lambda m: m.mass),
    )
    for values in vars(arrays).values():
        values.flags.writeable = False
    return arrays


__all__ = [
    "MOTORS",
    "Constant",
    "Motor",
    "MotorArrays",
    "catalogue",
    "find_motor",
    "gather",
    "load_motor",
    "motor_arrays",
    "motors_by_name",
]
