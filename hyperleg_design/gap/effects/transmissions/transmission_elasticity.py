"""Belts, cables and gears that give under load."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import Need
from hyperleg_design.gap.effects.families import BESIDE_TRANSMISSIONS, FRICTION, LATE
from hyperleg_design.gap.effects.kinds import GearEffect
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placing import SIDES
from hyperleg_design.gap.effects.transmissions import belt
from hyperleg_design.gap.model import machine
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration
from hyperleg_design.simulation.drives.two_mass import DAMPING_RATIO, Belt

RESONANCE = 12.0
"""Usual frequency of a rotor on its belt, its joint held [Hz]: belts ring at 5-30 Hz."""
RESONANCES = (40.0, 20.0, 10.0, 5.0)
"""Resonance frequencies of rotors from which a search starts [Hz]."""
SWINGS, SWING_DAMPING = (20.0, 10.0, 6.0, 4.0, 2.5), 0.15
"""The same of joints that swing on the belts of rotors whose motion is logged, and the damping
ratio of the swing there [-]."""
SLOWEST = 0.5
"""Lowest frequency of a rotor on its belt that is searched [Hz]."""
STIFFER = 30.0
"""Usual stiffening [1/rad], twice as stiff at 2 degrees; that a search starts from, too."""
SIDE = 2
"""Parameter that tells where encoders are."""
TELLING = 8.0
"""Content of the motion that tells elasticity from delay [Hz]."""
COMPLIANCE_SOURCE = "belt resonance 5-30 Hz (engineering estimate); `usual` knows the rotor"
DAMPING_RATIO_SOURCE = "steel-corded belts ring for a few periods (assumed)"
STIFFENING_SOURCE = "gears are two to three times as stiff beyond some mrad (data sheets)"


class TransmissionElasticity(GearEffect):
    """A motor and its joints are joined by a spring, on the motor's side of the transmission; see
    `belt`.

    The rotor on its belt, the joint held, rings at 1 / (2 pi sqrt(J compliance)).
    """

    identifier: ClassVar[str] = "transmission_elasticity"
    stretched: ClassVar[bool] = True
    rough: ClassVar[Mapping[str, float]] = {"compliance": 0.15}
    """How rotors move on belts that give was 10 to 25 % off in development."""
    summary: ClassVar[str] = "a belt, cable or gear gives under load, so motor and joint move apart"
    built: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("compliance", "rad/Nm", 0.0, 0.0, 1e4, 0.01, COMPLIANCE_SOURCE),
        Parameter(
            "damping_ratio", "", DAMPING_RATIO, 0.0, 1.0, 0.05, DAMPING_RATIO_SOURCE, shape=True
        ),
        Parameter("side", "", 0.0, 0.0, 1.0, 1.0, "a choice", shape=True, choices=SIDES),
        Parameter("behind", "", 0.0, 0.0, 1.0, 1.0, "a choice", shape=True, choices=belt.RUBBING),
        Parameter("stiffening", "1/rad", 0.0, 0.0, 200.0, STIFFER, STIFFENING_SOURCE, shape=True),
    )
    needs: ClassVar[Need] = Need(
        lambda motion: motion.content > TELLING,
        f"motion reaches past {TELLING:.0f} Hz",
        f"motion holds nothing above {TELLING:.0f} Hz: a stiff belt looks like a delay; a soft one "
        "may show where encoders sit on the rotors",
        speeds=True,
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "several amplitudes": FRICTION - {"viscous_friction"} | {"backlash"},
        "chirp past 8 Hz": LATE | {"controller_gain", "rotor_inertia", "viscous_friction"},
        "log rotor speeds": BESIDE_TRANSMISSIONS,
    }
    look_alikes: ClassVar[Mapping[str, str]] = {"command_delay": "a chirp past 8 Hz"}

    @override
    def holds_torque(self, values: np.ndarray) -> bool:
        return bool(values[SIDE] >= belt.CHOSEN and (values[3] >= belt.CHOSEN or values[4] > 0))

    @override
    def _left(self, signals: Signals, motor: int, *values: Any) -> dict[str, np.ndarray]:
        compliance, damping_ratio, side, behind, stiffening = values
        load = belt.load(signals, motor)
        at_rotor, bent = side >= belt.CHOSEN, (stiffening > 0) | (behind >= belt.CHOSEN)
        moved = belt.stretch(
            signals, load, motor, compliance, damping_ratio, stiffening, at_rotor & ~bent
        )
        for rubs in (True, False):
            if (mine := bent & at_rotor & ((behind >= belt.CHOSEN) == rubs)).any():
                given = belt.given(signals, motor, rubs=rubs)
                moved[mine] = belt.stretch(
                    signals,
                    given,
                    motor,
                    *(v[mine] for v in (compliance, damping_ratio, stiffening)),
                )
        before = np.where(at_rotor, 0.0, 1 - behind)[:, None]
        if before.any():
            rubbing = belt.rubbing(signals, motor)
            moved -= before * belt.stretch(signals, rubbing, motor, compliance, damping_ratio)
        return belt.trace(signals, motor, moved, side, behind)

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        values = np.asarray(values, float)
        compliance, ratio = values[..., 0], values[..., 1]
        inertia = machine.rotor(subject, subject.motors.index(location))
        damping = 2 * ratio * np.sqrt(inertia / np.where(compliance > 0, compliance, np.inf))
        bend = values[..., 4] / subject.motor_over_joint(subject.motors.index(location))
        return Belt(
            location, compliance=compliance, damping=damping, side=values[..., 2], stiffening=bend
        )

    @override
    def usual(self, location: str, subject: Subject) -> np.ndarray:
        """Usual values, with the compliance at which the rotor rings at `RESONANCE`."""
        typical = super().usual(location, subject)
        typical[0] = self._compliance(RESONANCE, location, subject)
        return typical

    @override
    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """Usual bounds, with no more compliance than that of a rotor that rings at half a hertz."""
        bounds = super().bounds(location, subject)
        bounds[1, 0] = min(bounds[1, 0], self._compliance(SLOWEST, location, subject))
        return bounds

    @override
    def fixed(self, values: np.ndarray) -> np.ndarray:
        """Of a belt that stiffens, and with encoders at the rotors, where joints rub, and where
        encoders sit; else it is straight.
        """
        at_rotors, stiffens = values[SIDE] >= belt.CHOSEN, values[4] > 0
        bent = stiffens or (at_rotors and values[3] >= belt.CHOSEN)
        return np.array([False, False, bent, at_rotors or stiffens, not bent])

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """Several resonances, with encoders on either side, and with joints that rub behind a belt,
        which may stiffen.
        """
        stiff = [self._compliance(frequency, location, signals.subject) for frequency in RESONANCES]
        motor = signals.subject.motors.index(location)
        over = belt.carried(signals, motor).mean() / machine.rotor(signals.subject, motor)
        damped = min(SWING_DAMPING * np.sqrt(over), 1.0)
        plain = [[c, DAMPING_RATIO, 0.0, 1.0, 0.0] for c in stiff]
        plain += [[c, DAMPING_RATIO, 0.0, 0.0, 0.0] for c in stiff[1:3]]
        plain += [
            [self._compliance(f, location, signals.subject) / over, damped, 1.0, 0.0, 0.0]
            for f in SWINGS
        ]
        bent = [
            [c, DAMPING_RATIO, 1.0, behind, bend]
            for behind, bend in ((0.0, STIFFER), (1.0, 0.0), (1.0, STIFFER))
            for c in stiff[1:3]
        ]
        return np.array(plain + bent)

    @override
    def derived(
        self, location: str, values: np.ndarray, subject: Subject
    ) -> dict[str, tuple[float, str]]:
        """Stiffness on the motor's side, and the frequency of the rotor on its belt."""
        stiffness = 1 / values[0] if values[0] > 0 else np.inf
        inertia = machine.rotor(subject, subject.motors.index(location))
        return {
            "stiffness": (float(stiffness), "Nm/rad"),
            "resonance": (float(np.sqrt(stiffness / inertia) / (2 * np.pi)), "Hz"),
        }

    def _compliance(self, frequency: float, location: str, subject: Subject) -> float:
        inertia = machine.rotor(subject, subject.motors.index(location))
        return float(1 / (inertia * (2 * np.pi * frequency) ** 2))
