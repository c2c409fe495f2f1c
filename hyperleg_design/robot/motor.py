"""A motor: constants as published, with convention, source and confidence; the rest is computed.

Power constant: Joule heat over squared torque, `Cp = f R / Kt^2` with R line to line and f by the
current that Kt divides by: 1 for direct current through two phases, 3/4 for the amplitude of a
sinusoidal phase current, 3/2 for its rms.

Stall torque: the DC-motor line `tau = tau_stall (1 - omega / omega_0)`, with `tau_stall = omega_0 /
Cp`, because `V = R i + Ke omega` and `Ke = Kt` give `R V / (R Ke) = omega_0 Kt^2 / R`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.reading import given_path, read_yaml
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.entries import check_keys
from hyperleg_design.robot.parameters.fields import Rule

CONFIDENCES = ("high", "medium", "low")
RPM = 2 * math.pi / 60
_RULES = {
    "nominal_voltage": Rule("number", "V", 1, 1000),
    "no_load_speed_rpm": Rule("number", "rpm", 10, 100_000),
    "peak_torque": Rule("number", "Nm", 1e-3, 200),
    "rated_torque": Rule("number", "Nm", 1e-3, 100),
    "torque_constant": Rule("number", "Nm/A", 1e-4, 10),
    "resistance": Rule("number", "ohm", 1e-4, 100),
    "rotor_inertia_g_cm2": Rule("number", "g cm^2", 0.1, 1e6),
    "mass_g": Rule("number", "g", 1, 20_000),
    "pole_pairs": Rule("number", "", 1, 100),
}
_OPTIONAL = {
    "back_emf_V_krpm": Rule("number", "V/krpm", 1e-3, 1000),
    "inductance_uH": Rule("number", "uH", 0.1, 1e6),
    "peak_current": Rule("number", "A", 0.1, 2000),
    "max_winding_temperature_degC": Rule("number", "degC", 40, 300),
    "thermal_resistance": Rule("number", "K/W", 1e-3, 100),
}
_PRESET = {
    "no_load_speed": Rule("number", "rad/s", 1, 10_000),
    "peak_torque": Rule("number", "Nm", 1e-3, 200),
    "power_constant": Rule("number", "W/Nm^2", 1e-4, 1e5),
}
HEAT_FACTOR = {"dc": 1.0, "phase_peak": 0.75, "phase_rms": 1.5}
"""Factor f of the power constant, by the current that the torque constant divides by [-]."""


@dataclass(frozen=True)
class Constant:
    """One published or estimated number."""

    value: float
    """Number in the unit that the name of the field states."""
    label: str
    """One of `parameters.LABELS`; `user` for a plain value."""
    source: str
    """Document, page or reason."""
    confidence: str
    """`high`, `medium` or `low`, which is also that of a plain value."""


@dataclass(frozen=True)
class Motor:
    """One motor, without a gear."""

    name: str
    vendor: str
    product: str
    kind: str
    """`inrunner`, `outrunner` or `flat`."""
    description: str
    constants: Mapping[str, Constant]
    """Published numbers by field name."""
    resistance_convention: str
    """`line_line` or `phase`."""
    current_convention: str
    """Current that the torque constant divides by: `dc`, `phase_peak` or `phase_rms`."""
    presets: Mapping[str, Mapping[str, Constant]] = field(default_factory=dict)
    """Named other sets of no-load speed, peak torque and power constant."""

    def __hash__(self) -> int:
        return hash(self.name)

    def _value(self, name: str) -> float:
        return self.constants[name].value

    @property
    def mass(self) -> float:
        """Mass of the bare motor, without gear [kg]."""
        return self._value("mass_g") * 1e-3

    @property
    def rotor_inertia(self) -> float:
        """Inertia of the rotor about its axis [kg m^2]."""
        return self._value("rotor_inertia_g_cm2") * 1e-7

    @property
    def rated_torque(self) -> float:
        """Torque that the motor can give continuously [Nm]."""
        return self._value("rated_torque")

    @property
    def torque_constant(self) -> float:
        """Torque constant as the vendor publishes it [Nm/A]; `current_convention` says which
        current it divides by.
        """
        return self._value("torque_constant")

    @property
    def nominal_voltage(self) -> float:
        """Supply voltage for which the no-load speed is stated [V]."""
        return self._value("nominal_voltage")

    @property
    def line_resistance(self) -> float:
        """Resistance of the winding between two lines [ohm]."""
        return self._value("resistance") * (2.0 if self.resistance_convention == "phase" else 1.0)

    def power_constant(self, constants: str = "paper") -> float:
        """Compute the power constant Cp, Joule heat over squared torque.

        Args:
            constants: name of the preset of constants, as in `no_load_speed`; a preset states Cp
                itself.

        Returns:
            Cp [W/Nm^2].
        """
        preset = self.presets.get(constants)
        if preset is not None:
            return preset["power_constant"].value
        return HEAT_FACTOR[self.current_convention] * self.line_resistance / self.torque_constant**2

    def no_load_speed(self, constants: str = "paper") -> float:
        """Look up the speed without load at the nominal voltage.

        Args:
            constants: name of the preset of constants, `paper` or `vendor`; a motor that lacks the
                preset uses the vendor's constants.

        Returns:
            The speed [rad/s].
        """
        preset = self.presets.get(constants)
        return (
            preset["no_load_speed"].value
            if preset is not None
            else self._value("no_load_speed_rpm") * RPM
        )

    def peak_torque(self, constants: str = "paper") -> float:
        """Look up the largest torque of the motor, which it gives for a short time.

        Args:
            constants: name of the preset of constants, as in `no_load_speed`.

        Returns:
            The torque [Nm].
        """
        preset = self.presets.get(constants)
        return preset["peak_torque"].value if preset is not None else self._value("peak_torque")

    def stall_torque(self, constants: str = "paper") -> float:
        """Compute the torque at which the line of the DC motor meets zero speed, omega_0 / Cp.

        Args:
            constants: name of the preset of constants, as in `no_load_speed`.

        Returns:
            The torque [Nm].
        """
        return self.no_load_speed(constants) / self.power_constant(constants)

    def corner_speed(self, constants: str = "paper") -> float:
        """Compute the speed up to which the peak torque is available.

        Args:
            constants: name of the preset of constants, as in `no_load_speed`.

        Returns:
            The speed [rad/s]; 0 where the line is below the peak torque at any speed.
        """
        return max(
            0.0,
            self.no_load_speed(constants)
            * (1 - self.peak_torque(constants) / self.stall_torque(constants)),
        )

    def motor_constant(self, constants: str = "paper") -> float:
        """Compute the motor constant Km = Cp^-1/2, torque over the root of the heat.

        Args:
            constants: name of the preset of constants, as in `no_load_speed`.

        Returns:
            Km [Nm/W^1/2].
        """
        return self.power_constant(constants) ** -0.5

    def rated_heat(self, constants: str = "paper") -> float:
        """Compute the Joule heat at the rated torque, Cp tau_rated^2, which the motor carries for
        ever.

        Args:
            constants: name of the preset of constants, as in `no_load_speed`.

        Returns:
            The heat [W].
        """
        return self.power_constant(constants) * self.rated_torque**2


def load_motor(path: Path) -> Motor:
    """Read one file of the motor catalogue.

    Args:
        path: of the motor's YAML file.

    Returns:
        The motor, in SI units.

    Raises:
        InputError: names file, field, value and remedy.
    """
    data = read_yaml(path)
    where = given_path(path)
    optional = ("name", "vendor", "product", "description", "presets")
    check_keys(data, where, "", ("kind", "constants", "convention"), optional)
    if data.get("name", path.stem) != path.stem:
        remedy = f"must equal the file's name, {path.stem}, or be left out"
        raise InputError(where, "name", data["name"], remedy)
    convention = data["convention"]
    if not isinstance(convention, dict):
        raise InputError(
            where, "convention", convention, "expects a mapping with resistance and current"
        )
    check_keys(
        convention, where, "convention", (), ("resistance", "current", "source", "confidence")
    )
    _one_of(convention.get("resistance"), ("line_line", "phase"), where, "convention.resistance")
    _one_of(convention.get("current"), tuple(HEAT_FACTOR), where, "convention.current")
    _one_of(data["kind"], ("inrunner", "outrunner", "flat"), where, "kind")
    presets = {}
    declared = data.get("presets") or {}
    if not isinstance(declared, dict):
        raise InputError(where, "presets", declared, "expects a mapping of names to constants")
    for name, preset in declared.items():
        presets[str(name)] = _constants(preset, _PRESET, {}, where, f"presets.{name}")
    motor = Motor(
        name=path.stem,
        vendor=str(data.get("vendor", "")),
        product=str(data.get("product", "")),
        kind=str(data["kind"]),
        description=str(data.get("description", "")),
        constants=_constants(data["constants"], _RULES, _OPTIONAL, where, "constants"),
        resistance_convention=convention["resistance"],
        current_convention=convention["current"],
        presets=presets,
    )
    if motor._value("pole_pairs") % 1:
        raise InputError(
            where, "constants.pole_pairs", motor._value("pole_pairs"), "expects a whole number"
        )
    if motor.rated_torque > motor._value("peak_torque"):
        raise InputError(
            where, "constants.rated_torque", motor.rated_torque, "must not exceed peak_torque"
        )
    return motor


def _one_of(value: Any, choices: tuple[str, ...], where: str, field: str) -> None:
    if value not in choices:
        raise InputError(where, field, value, f"expects one of {', '.join(choices)}")


def _constants(
    data: Any, required: Mapping[str, Rule], optional: Mapping[str, Rule], where: str, path: str
) -> dict[str, Constant]:
    if not isinstance(data, Mapping):
        raise InputError(where, path, data, f"expects a mapping with {', '.join(required)}")
    rules = {**required, **optional}
    check_keys(data, where, path, (), tuple(rules))
    missing = [f"{k} [{rule.unit or '-'}]" for k, rule in required.items() if k not in data]
    if missing:
        raise InputError(where, path, None, f"lacks {', '.join(missing)}")
    constants = {}
    for key, entry in data.items():
        place = f"{path}.{key}"
        value, origin = parameters.labelled(entry, where, place)
        sure = entry.get("confidence", "low") if isinstance(entry, Mapping) else "low"
        _one_of(sure, CONFIDENCES, where, f"{place}.confidence")
        number = parameters.checked(value, rules[key], where, place)
        constants[key] = Constant(number, origin.label, origin.source, sure)
    return constants
