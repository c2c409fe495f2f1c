"""One effect alone: the trace it leaves in a log of a standard motion, and how the closed loop
moves with and without it.

The standard motion is a chirp on one joint, its base fixed; or, for effects of the ground and of
the inertial sensor, a biped that bends its knees and presses its feet apart. It is simulated with
the effect, conditioned as any log, and the trace set beside the residual. Temperature and battery
voltage, which no simulation here has, are made up as stated below, so that effects which need them
have something to show.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design import resources
from hyperleg_design.errors import InputError, meant
from hyperleg_design.gap.effects import EFFECTS, effect
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.model.joint_units import slides, unit_at
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.playback.standard_run import TICK, simulated_log
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.signals import Signals, row_names, row_units

DURATION, STANDING = 12.0, 6.0
"""Of the chirp, and of the biped's motion [s]."""
LOWEST, HIGHEST = 0.2, 6.0
"""Of the chirp [Hz]."""
AMPLITUDE = 0.4
"""Of the chirp at its lowest frequency [rad]; it falls as 1 / (1 + f / 2 Hz)."""
KNEE_BEND, SPREAD = 0.15, 0.55
"""Posture of the shown biped: bend of its thighs, and turn of both hips outward [rad]."""
NOTHING = 1e-9
"""Trace that counts as none [Nm, N]."""


@dataclass(frozen=True, eq=False)
class Shown:
    """An effect on the standard motion of `t` ticks."""

    effect: Effect
    robot: str
    location: str
    values: np.ndarray
    """Values of the effect's parameters."""
    units: tuple[str, ...]
    """Of the parameters at this place."""
    time: np.ndarray
    """Times of the samples `(t,)` [s]."""
    residual_name: str
    """In which its trace is largest; empty where it leaves none."""
    row: str
    """Joint, motor, axis of the base or foot with the largest trace."""
    unit: str
    """Unit of the trace and the residual."""
    trace: np.ndarray
    """`(t,)`; NaN where unknown."""
    residual: np.ndarray
    """Of the same row in a simulated log with the effect, raw `(t,)`."""
    joint: str
    """Whose motion is shown."""
    slides: bool
    """Whether that joint slides: its motion is in m then, its torque in N."""
    position: np.ndarray
    velocity: np.ndarray
    torque: np.ndarray
    """Of that joint in the log with the effect `(t,)` [rad, rad/s, Nm]."""
    target: np.ndarray
    """Position target of the joint `(t,)` [rad]."""
    before: np.ndarray
    after: np.ndarray
    """Position that the simulation reaches without and with the effect, as the sensor tells `(t,)`
    [rad]."""

    @property
    def parameters(self) -> dict[str, float]:
        """The values of the effect's parameters by name."""
        return {p.name: float(v) for p, v in zip(self.effect.parameters, self.values, strict=True)}


def effects_table() -> list[dict[str, Any]]:
    """Tabulate the catalogue of effects.

    Returns:
        One entry for each effect: identifier, kind of place, summary, and parameters with
        magnitudes and sources.
    """
    return [
        {
            "effect": effect.identifier,
            "where": effect.kind,
            "summary": effect.summary,
            "parameters": [dataclasses.asdict(p) for p in effect.parameters],
        }
        for effect in EFFECTS.values()
    ]


def show(
    identifier: str,
    robot: str | None = None,
    *,
    location: str | None = None,
    settings: Sequence[str] = (),
) -> Shown:
    """Show an effect alone.

    Args:
        identifier: of the effect.
        robot: a design, MJCF or URDF; by default one joint on a servo, or the biped for effects
            that need the ground.
        location: where it sits; the first place that it can by default.
        settings: `PARAMETER=VALUE` each; the usual magnitude by default.

    Returns:
        Trace, residual and closed loop with and without the effect.

    Raises:
        InputError: no such effect, place or parameter, or a robot on which it cannot sit.
    """
    shown_effect = effect(identifier)
    standing = shown_effect.kind in ("foot", "sensor")
    subject = _subject(robot, standing)
    places = shown_effect.locations(subject)
    if location is None:
        if not places:
            remedy = f"has no {shown_effect.kind} for it; choose another --robot"
            raise InputError(identifier, "robot", subject.name, remedy)
        location = places[-1] if shown_effect.kind == "link" and not standing else places[0]
    location = shown_effect.place(location, subject)
    values = _values(shown_effect, location, subject, settings)
    joint = _joint(subject, location)
    time = np.arange(round((STANDING if standing else DURATION) / TICK) + 1) * TICK
    target = _stand_targets(subject, time) if standing else _chirp(subject, joint, time)
    before, _ = simulated_log(subject, target, time, ())
    after, log = simulated_log(
        subject, target, time, (shown_effect.alteration(location, values, subject),)
    )
    signals = condition(_with_sensor_bias(shown_effect, log, values), subject)
    residual_name, row, unit, trace, residual = _largest(
        shown_effect.trace(signals, location, values[None]), signals
    )
    return Shown(
        effect=shown_effect,
        robot=subject.name,
        location=location,
        values=values,
        units=tuple(
            unit_at(subject, shown_effect.kind, location, p.unit) for p in shown_effect.parameters
        ),
        time=signals.time,
        residual_name=residual_name,
        row=row,
        unit=unit,
        trace=trace,
        residual=residual,
        joint=subject.joints[joint],
        slides=slides(subject, "joint", subject.joints[joint]),
        position=signals.position[:, joint],
        velocity=signals.velocity[:, joint],
        torque=(signals.believed @ subject.joint_from_motor.T)[:, joint],
        target=target[:, joint],
        before=before[:, joint],
        after=after[:, joint],
    )


def _subject(robot: str | None, standing: bool) -> Subject:
    name = robot or (
        "hyperleg" if standing else str(resources.content_folder("sim") / "servo_rig.xml")
    )
    subject = load_subject(name)
    if subject.floating == standing:
        return subject
    blank = np.zeros(2)
    joints = {f"position/{name}": blank for name in subject.joints}
    metadata = Metadata(base="floating" if standing else "fixed")
    return load_subject(name, [Log("standard motion", np.array([0.0, 1.0]), joints, metadata)])


def _values(effect: Effect, location: str, subject: Subject, settings: Sequence[str]) -> np.ndarray:
    values = effect.example(location, subject)
    known = {p.name: i for i, p in enumerate(effect.parameters)}
    for setting in settings:
        name, sign, text = setting.partition("=")
        if not sign or name not in known:
            remedy = f"expects PARAMETER=VALUE; {meant(name, known)}"
            raise InputError("set", setting, None, remedy)
        try:
            value = float(text)
        except ValueError:
            raise InputError("set", name, text, "expects a number") from None
        values[known[name]] = effect.parameters[known[name]].checked(value, "set", name)
    return values


def _joint(subject: Subject, location: str) -> int:
    """Joint that moves for an effect at a place."""
    if location in subject.joints:
        return subject.joints.index(location)
    if location in subject.motors:
        return subject.main_joint(subject.motors.index(location))
    if location in subject.links:
        carrier = int(subject.tree.link_joint[subject.tree.link(location)])
        return max(carrier, 0)
    knees = [i for i, name in enumerate(subject.joints) if "knee" in name]
    return knees[0] if knees else 0


def _chirp(subject: Subject, joint: int, time: np.ndarray) -> np.ndarray:
    """Targets `(t, n)`: one joint sweeps up in frequency about its rest, the others hold."""
    rate = np.log(HIGHEST / LOWEST) / DURATION
    frequency = LOWEST * np.exp(rate * time)
    phase = 2 * np.pi * LOWEST / rate * (np.exp(rate * time) - 1)
    low, high = subject.position_low[joint], subject.position_high[joint]
    centre, amplitude = float(subject.default[joint]), AMPLITUDE
    if np.isfinite(high - low):
        amplitude = min(amplitude, 0.4 * (high - low))
        centre = float(np.clip(centre, low + 1.1 * amplitude, high - 1.1 * amplitude))
    target = np.tile(subject.default, (len(time), 1))
    target[:, joint] = centre + amplitude / (1 + frequency / 2.0) * np.sin(phase)
    return target


def _stand_targets(subject: Subject, time: np.ndarray) -> np.ndarray:
    """Targets `(t, n)` of a biped that bends its knees once in two seconds and pushes its feet
    apart and together.
    """
    target = np.tile(subject.default, (len(time), 1))
    bend = KNEE_BEND * (1 - np.cos(np.pi * time)) / 2
    apart = SPREAD * np.sin(1.3 * np.pi * time)
    shares = {"hip_pitch": -bend, "knee": 2 * bend, "ankle_pitch": -bend}
    for place, joint in enumerate(subject.joints):
        for name, moved in shares.items():
            if joint.endswith(name):
                target[:, place] += moved
        if joint.endswith("hip_roll"):
            target[:, place] += apart
    return target


def _with_sensor_bias(effect: Effect, log: Log, values: np.ndarray) -> Log:
    """The log as the robot's own inertial sensor would have measured it, with its bias."""
    if effect.kind != "sensor":
        return log
    columns = (parameter.name.replace("_", "/") for parameter in effect.parameters)
    bias = dict(zip(columns, values, strict=True))
    signals = {name: column + bias.get(name, 0.0) for name, column in log.signals.items()}
    return dataclasses.replace(log, signals=signals)


def _largest(
    traces: Mapping[str, np.ndarray], signals: Signals
) -> tuple[str, str, str, np.ndarray, np.ndarray]:
    """The first of the residuals in which there is a trace, its row with the largest, its unit,
    that trace, and the residual.
    """
    traces = signals.shown(traces)
    for residual_name in ("motion", "drive", "ground", "base", "transmission"):
        if residual_name not in traces:
            continue
        rows = np.where(signals.valid[:, None], traces[residual_name][0], np.nan)
        if residual_name == "motion":
            rows = np.where(np.isfinite(signals.residual["motion"]), rows, np.nan)
        size = np.sqrt(np.where(np.isfinite(rows), rows, 0.0) ** 2).mean(0)
        place = int(np.argmax(size))
        if size[place] > NOTHING:
            unit = row_units(signals.subject, residual_name)[place]
            trace, residual = rows[:, place], signals.residual[residual_name][:, place]
            residual = np.where(np.isfinite(trace), residual, np.nan)
            name = row_names(signals.subject, residual_name)[place]
            return residual_name, name, unit, trace, residual
    unknown = np.full(len(signals.time), np.nan)
    return "", "", "Nm", unknown, unknown
