"""What every effect of the catalogue is: identifier, places, parameters, its trace in the residuals
and its way into the simulation.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence, Set
from typing import ClassVar

import numpy as np

from hyperleg_design.errors import InputError, meant
from hyperleg_design.gap.effects.excitation import Excitation, Motion, Need, shown_by
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placed import Hooks, Placed
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration

KINDS = ("joint", "motor", "link", "foot", "sensor", "robot")
"""Where an effect can sit."""
LOGGED, NEEDED, STEERED = NUISANCE_TORQUES = ("logged", "needed", "steered")
"""Torques that a trace of a nuisance parameter rests on: the log's; those that the motion needs; or
the log's with targets by which controllers ask for those, where nobody measured torques."""

PROPER = {"coulomb": "Coulomb", "stribeck": "Stribeck", "imu": "IMU"}
"""Words of identifiers that have a spelling of their own."""
Change = Mapping[tuple[str, str], Mapping[str, float]]
"""Values of parameters by (effect, location): what is added to a simulation; empty, the simulation
as it is."""


class Effect(ABC):
    """One unmodelled effect; a class without state.

    Every residual is what the log shows minus what the model explains, so that a log of a robot
    with the effect at `values` has, apart from noise, the residual `trace(signals, location,
    values)`; at the nulls the trace is zero.
    """

    identifier: ClassVar[str]
    kind: ClassVar[str]
    """Kind of place where it acts, one of `KINDS`."""
    summary: ClassVar[str]
    """One line for people."""
    telling: ClassVar[str] = ""
    """Parameter, or what follows from some, by which people know its size; else the first one that
    is clearly there."""
    parameters: ClassVar[tuple[Parameter, ...]]
    linear: ClassVar[bool] = False
    """Whether the trace is linear in (values - nulls), but for parameters that only shape it: these
    are one of `variants`."""
    needs: ClassVar[Need]
    """What it needs of a motion to show."""
    hooks: ClassVar[type[Hooks]]
    """What it does at its joint or motor in each step of a simulation, with its parameters as
    constants; needed where `alteration` is not overridden."""
    listed: ClassVar[bool] = True
    """Whether the catalogue has it, so that answers name it as a cause. One that it lacks competes
    with those that it has; where it wins, something unlisted acts, which `describe` tells."""
    flexible: ClassVar[bool] = False
    """Whether it is no effect of the catalogue but a function of many shapes whose sizes shrink to
    nothing. It acts under test alone, and pays for no parameter beside the marginal likelihood."""
    rare: ClassVar[float] = 0.0
    """Log prior odds over those of an effect that looks like it, of one that is rarer [nat]."""
    unseen: ClassVar[float] = 0.0
    """Log prior odds for it where no log has what shows it (`driven`): a model of that fits much
    [nat]."""
    described: ClassVar[bool] = False
    """Whether a robot's model describes it, so that there may also be less of it than described."""
    rough: ClassVar[Mapping[str, float]] = {}
    """Standard deviation over the value, of parameters that follow from a trace at first order."""
    stretched: ClassVar[bool] = False
    """Whether a load, with all of its noise, shapes the trace; the first parameter sizes it."""
    lags: ClassVar[bool] = False
    """Whether torques lag behind what is asked for; the first parameter is the time constant."""
    scales: ClassVar[str] = ""
    """`motor` or `joint` where it scales a torque that the residual of motion trusts."""
    holds_back: ClassVar[bool] = False
    """Whether a part of what controllers ask for does not arrive, as beyond a limit."""
    scales_measured: ClassVar[bool] = True
    """Whether it scales torque that is measured, too, not only what a controller asks for."""
    told_apart: ClassVar[Mapping[str, Set[str]]] = {}
    """By name of an experiment, effects that it tells apart; that one of two says so is enough."""
    by_load: ClassVar[bool] = False
    """Whether it grows with the load that a joint carries, whatever makes that load."""
    inertial: ClassVar[bool] = False
    """Whether it is of masses or rotors. Its usual errors are the same in all sessions, as these do
    not change overnight, and its trace counts as far as drives feel accelerations."""
    built: ClassVar[bool] = False
    """Whether it is a matter of how a joint is built, of its belt, gear or rotor, which is the same
    in all sessions: references do not differ from one another by it."""
    of_zeros: ClassVar[bool] = False
    """Whether it is what a wrong zero of an encoder leaves; its one parameter is the angle."""
    nuisance_rank: ClassVar[int] = 0
    """Order of its nuisance parameters among those of other effects at the same place; sums over
    them keep it, so that answers are the same to the last digit."""
    nuisance_torque: ClassVar[str] = LOGGED
    """One of `NUISANCE_TORQUES`: by which torques its nuisance parameters leave their traces."""
    look_alikes: ClassVar[Mapping[str, str]] = {}
    """Effects that are taken for this one most, and what separates them; one of two may say so."""

    def driven(self, signals: Signals) -> bool:
        """Tell whether a log has what shows the effect by itself; by default it has.

        Args:
            signals: the conditioned log.
        """
        return True

    @abstractmethod
    def locations(self, subject: Subject) -> tuple[str, ...]:
        """Names of the places where it can sit on this robot."""

    def place(self, location: str, subject: Subject) -> str:
        """The element of `locations` that a name means.

        Args:
            location: name of the place, as people may write it.
            subject: the robot.

        Returns:
            The location.

        Raises:
            InputError: none.
        """
        locations = self.locations(subject)
        if location in locations:
            return location
        if not locations:
            raise InputError(
                self.identifier, "location", location, f"this robot has no {self.kind} for it"
            )
        raise InputError(self.identifier, "location", location, meant(location, locations))

    def excited(self, log: Log, motion: Motion) -> Excitation:
        """Whether a log can show it, where, and why or why not; by default as it `needs`.

        Args:
            log: as it was read.
            motion: facts of it.
        """
        return shown_by(self.identifier, self.needs, log, motion)

    @abstractmethod
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        """Compute what it leaves in each of the log's residuals.

        Args:
            signals: a conditioned log, `t` ticks.
            location: one of `locations`.
            values: `(k, parameters)`, k settings at once.

        Returns:
            By name of the residual `(k, t, rows)` [Nm; N in the ground residual], before any
            filtering; residuals that it leaves alone are missing. Unknown ticks are NaN.
        """

    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """What adds it to a simulation; by default its `hooks`.

        Args:
            location: one of `locations`.
            values: `(parameters,)`, or `(n, parameters)`, one row a simulation; rows at the nulls
                leave theirs alone.
            subject: the robot.
        """
        columns = np.moveaxis(np.asarray(values, float), -1, 0)
        names = (parameter.name for parameter in self.parameters)
        return Placed(location, dict(zip(names, columns, strict=True)), live=self.hooks)

    def strength(self, location: str, subject: Subject) -> float:
        """Torque for which the joint or motor at a place is made [Nm]; 1 of other places.

        Args:
            location: one of `locations`.
            subject: the robot.
        """
        return 1.0

    def _sized(self, sizes: Iterable[float], location: str, subject: Subject) -> np.ndarray:
        """Sizes of the parameters at a place, of those that are shares of its strength."""
        shares = [parameter.of_strength for parameter in self.parameters]
        return np.array(list(sizes)) * np.where(shares, self.strength(location, subject), 1.0)

    def usual(self, location: str, subject: Subject) -> np.ndarray:
        """Scale of priors and of finite differences at a place of a robot.

        Args:
            location: one of `locations`.
            subject: the robot.

        Returns:
            Usual distances from the nulls `(parameters,)`.
        """
        return self._sized((p.typical for p in self.parameters), location, subject)

    def example(self, location: str, subject: Subject, size: float = 1.0) -> np.ndarray:
        """Values at which it can be seen: at `size` times the usual distance, inside the bounds.

        Args:
            location: one of `locations`.
            subject: the robot.
            size: over the usual distance from the nulls.

        Returns:
            Values `(parameters,)`.
        """
        values, usual = self.nulls, self.usual(location, subject).tolist()
        for k, (parameter, distance) in enumerate(zip(self.parameters, usual, strict=True)):
            if not parameter.shape:
                null = parameter.null
                above = min(null + size * distance, parameter.high)
                values[k] = above if above > null else max(null - size * distance, parameter.low)
        return values

    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """Least and largest values at a place of a robot, never wider than the parameters' own.

        Args:
            location: one of `locations`.
            subject: the robot.

        Returns:
            Least and largest values `(2, parameters)`.
        """
        return np.array([[p.low for p in self.parameters], [p.high for p in self.parameters]])

    def shown_bounds(self, logs: Sequence[Signals], location: str) -> np.ndarray:
        """As `bounds`, without the values that logs in which it acts rule out.

        Args:
            logs: conditioned logs.
            location: one of `locations`.

        Returns:
            Least and largest values `(2, parameters)`.
        """
        return self.bounds(location, logs[0].subject)

    def change_bounds(self, location: str, subject: Subject) -> np.ndarray:
        """As `bounds`, of a change since references, in which there may be what the model lacks.

        Args:
            location, subject: as of `bounds`.
        """
        return self.bounds(location, subject)

    def fixed(self, values: np.ndarray) -> np.ndarray:
        """Find the parameters with discrete values, which a fit does not move.

        Args:
            values: of the parameters `(parameters,)`.

        Returns:
            Whether each parameter stays `(parameters,)` of bool.
        """
        return np.zeros(len(self.parameters), bool)

    def odds(self, location: str, subject: Subject, values: np.ndarray) -> float:
        """Log prior odds for it at some values `(k,)`, over those at usual ones.

        Args:
            location: one of `locations`.
            subject: the robot.
            values: of the parameters `(parameters,)`.

        Returns:
            The log odds [nat].
        """
        return 0.0

    def size_odds(
        self, values: np.ndarray, usual: np.ndarray, declared: float, beyond: int
    ) -> float:
        """State log prior odds for a size, over those of any other cause in its place.

        Args:
            values: of the parameters `(k,)`.
            usual: their usual sizes `(k,)`.
            declared: payload that the logs declare at the place [kg].
            beyond: joints in a row that the link at the place carries.

        Returns:
            The log odds [nat]; none by default.
        """
        return 0.0

    def nuisance_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """State how far a healthy robot usually is from its model: its nuisance parameters, by
        default the `spread` of each.

        Args:
            subject: the robot.
            step: of its logs [s].

        Returns:
            Standard deviations from the nulls by location `(parameters,)`, zero for a parameter
            that is no nuisance; nothing where all are zero.
        """
        spreads = [p.spread for p in self.parameters]
        places = self.locations(subject) if any(spreads) else ()
        return {place: self._sized(spreads, place, subject) for place in places}

    def session_spreads(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """State how far parameters of a healthy robot usually are from what they were in reference
        logs, which teach what all sessions share.

        Args:
            subject: the robot.
            step: of its logs [s].

        Returns:
            As of `nuisance_spreads`.
        """
        return self.nuisance_spreads(subject, step)

    def usual_errors(self, subject: Subject, step: float) -> Mapping[str, np.ndarray]:
        """State how far a healthy robot usually is from its model, also at places where the effect
        has no nuisance parameter; a cause must be larger than that to be a fault.

        Args:
            subject: the robot.
            step: of its logs [s].
        """
        return self.nuisance_spreads(subject, step)

    def nuisance_trace(
        self, signals: Signals, location: str, parameter: int, spread: float
    ) -> dict[str, np.ndarray] | None:
        """Compute what a nuisance parameter leaves, where that is not `trace`.

        Args:
            signals: a conditioned log, `t` ticks.
            location: one of `locations`.
            parameter: index of the parameter.
            spread: its distance from the null.

        Returns:
            By name of the residual `(t, rows)`; None by default, for that of `trace`.
        """
        return None

    def holds_torque(self, values: np.ndarray) -> bool:
        """Tell whether its trace contains the measured motor torque, filtered, and so the noise of
        it.

        Args:
            values: of its parameters `(parameters,)`.
        """
        return False

    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """Values from which a search for the best fit begins, inside the bounds `(s, parameters)`.

        Args:
            signals: a conditioned log, `t` ticks.
            location: one of `locations`.
        """
        usual = self.usual(location, signals.subject)
        sized = np.array([not p.shape for p in self.parameters])
        low, high = self.bounds(location, signals.subject)
        tried = np.clip(
            self.nulls + np.array([[1.0], [-1.0]]) * np.where(sized, usual, 0.0), low, high
        )
        return np.asarray(tried[np.any(tried != self.nulls, 1)])

    def variants(self, signals: Signals, location: str) -> np.ndarray:
        """Of a linear effect, values of the parameters that only shape its trace, each worth a try
        `(v, parameters)`; the rest null.

        Args:
            signals: a conditioned log, `t` ticks.
            location: one of `locations`.
        """
        return self.nulls[None]

    def steps(self, location: str, subject: Subject) -> np.ndarray:
        """Steps of finite differences over which the trace is about straight `(parameters,)`.

        Args:
            location: one of `locations`.
            subject: the robot.
        """
        return 0.1 * self.usual(location, subject)

    def derived(
        self, location: str, values: np.ndarray, subject: Subject
    ) -> dict[str, tuple[float, str]]:
        """What people would rather read: quantities that follow from values.

        Args:
            location: one of `locations`.
            values: of the parameters `(parameters,)`.
            subject: the robot.

        Returns:
            Quantities by name, each with its unit.
        """
        return {}

    def describe(self, values: np.ndarray) -> str:
        """Describe in words an effect that is not `listed`.

        Args:
            values: of the parameters `(parameters,)`.

        Returns:
            A sentence whose subject is the location.
        """
        return ""

    def torque_slope(self, signals: Signals, motor: int, joint: int) -> np.ndarray:
        """Compute how the factor on a trusted torque changes with the first parameter.

        Args:
            signals: a conditioned log, `t` ticks.
            motor: index of the motor that gives the torque.
            joint: index of the joint that it moves most.

        Returns:
            The slope, `(t,)`, or `(1,)` where it is the same at all ticks.
        """
        return np.ones(1)

    @property
    def title(self) -> str:
        """Its name inside a sentence: `Coulomb friction`, `payload`."""
        return " ".join(PROPER.get(word, word) for word in self.identifier.split("_"))

    @property
    def nulls(self) -> np.ndarray:
        """Values at which it is absent, `(parameters,)`."""
        return np.array([p.null for p in self.parameters])
