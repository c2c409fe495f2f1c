"""What a case of the benchmark is: what is wrong with a robot, and the files that a diagnosis is
given.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from hyperleg_design.errors import InputError

SUITES = ("real", "drawn", "newcomers", "blind")
SPLITS = ("development", "held out")
KINDS = ("nothing", "single", "everywhere", "several", "outside")
"""Of cases: nothing wrong, one fault, one effect at several joints, several effects, an effect that
the catalogue lacks."""
CASE_FILE = "case.json"
"""In the folder of a case: the robot and the logs that a diagnosis is given, without the truth."""


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong with a robot, in the words of the catalogue."""

    effect: str
    """Identifier of the effect; one that the catalogue lacks where `listed` is false."""
    places: tuple[str, ...]
    """Names that count as its place, the proper one first."""
    parameters: Mapping[str, float] = field(default_factory=dict)
    """True values by the catalogue's names, SI units; only those that are known exactly."""
    equivalents: tuple[tuple[str, tuple[str, ...]], ...] = ()
    """Other effects, with their places, that these logs cannot tell from this one on physical
    grounds; an answer that names one of them is an honest equivalent."""
    listed: bool = True
    """Whether the catalogue has the effect."""

    def __post_init__(self) -> None:
        """Check."""
        if self.listed and not self.places:
            raise InputError("fault", "places", self.effect, "expects at least one place")

    def __str__(self) -> str:
        """Effect and proper place."""
        return f"{self.effect} at {self.places[0]}" if self.places else self.effect


@dataclass(frozen=True)
class Truth:
    """What is wrong in a case, and what counts for which row of the table."""

    faults: tuple[Fault, ...] = ()
    """Empty where nothing is wrong."""
    references: bool = False
    """Whether the diagnosis is given logs of the healthy robot."""
    identified: bool = True
    """Whether the model of the robot was identified by its makers, or is known exactly."""
    everywhere: bool = False
    """Whether the faults are one effect at several joints."""
    visible: bool | None = None
    """Of blind plants: whether each fault is at least twice what a clean log leaves; unknown of
    others."""

    @property
    def kind(self) -> str:
        """Which of `KINDS` the case is, by its faults."""
        if not self.faults:
            return "nothing"
        if not all(fault.listed for fault in self.faults):
            return "outside"
        if len(self.faults) == 1:
            return "single"
        return "everywhere" if self.everywhere else "several"

    def __str__(self) -> str:
        """All faults."""
        return ", ".join(str(fault) for fault in self.faults) or "nothing"


@dataclass(frozen=True, eq=False)
class Recording:
    """A log in the format of `docs/gap.md`, `t` ticks, free of any class of the diagnosis."""

    name: str
    time: np.ndarray
    """`(t,)` [s]."""
    signals: Mapping[str, np.ndarray]
    """By column `signal/name`, `(t,)` each."""
    metadata: Mapping[str, Any] = field(default_factory=dict)

    def declared(self, **values: Any) -> Recording:
        """A copy with some metadata replaced.

        Args:
            values: of the metadata, by field.

        Returns:
            The copy.
        """
        return replace(self, metadata={**self.metadata, **values})

    def without(self, *kinds: str) -> Recording:
        """A copy without the columns of some signals, such as `motor_torque`.

        Args:
            kinds: names of the signals.

        Returns:
            The copy.
        """
        columns = {c: v for c, v in self.signals.items() if c.split("/")[0] not in kinds}
        return replace(self, signals=columns)

    def scaled(self, factor: float, *columns: str) -> Recording:
        """A copy in which some columns are multiplied by a factor; absent columns are skipped.

        Args:
            factor: on the values.
            columns: their names.

        Returns:
            The copy.
        """
        present = {c: factor * self.signals[c] for c in columns if c in self.signals}
        return replace(self, signals={**self.signals, **present})

    def shifted(self, amount: float, column: str) -> Recording:
        """A copy in which a constant is added to one column.

        Args:
            amount: to add, in the column's unit.
            column: its name.

        Returns:
            The copy.

        Raises:
            InputError: there is no such column.
        """
        if column not in self.signals:
            raise InputError(self.name, column, None, "is no column of this recording")
        return replace(self, signals={**self.signals, column: self.signals[column] + amount})

    def early(self, seconds: float, kind: str) -> Recording:
        """A copy in which the columns of one signal are told `seconds` before they acted.

        The value at t is the one that was recorded at t + `seconds`; the last `seconds` are cut
        off.

        Args:
            seconds: by which it is told too early [s].
            kind: name of the signal.

        Returns:
            The copy.
        """
        keep = self.time <= self.time[-1] - seconds
        columns = {
            c: np.interp(self.time[keep] + seconds, self.time, v)
            if c.split("/")[0] == kind
            else v[keep]
            for c, v in self.signals.items()
        }
        return replace(self, time=self.time[keep], signals=columns)

    def part(self, begin: float, end: float) -> Recording:
        """The ticks from `begin` to `end` [s].

        Args:
            begin: first time [s].
            end: last time [s].

        Returns:
            The copy.
        """
        keep = (self.time >= begin) & (self.time <= end)
        columns = {c: v[keep] for c, v in self.signals.items()}
        return replace(self, time=self.time[keep], signals=columns)


@dataclass(frozen=True, eq=False)
class Material:
    """What a diagnosis is given."""

    robot: str
    """Text of an MJCF file (it begins with `<`), path of a robot file, or name of a design."""
    logs: tuple[Recording, ...]
    references: tuple[Recording, ...] = ()


@dataclass(frozen=True)
class Case:
    """One case; `build` makes its files afresh, from frozen seeds or from logs outside the
    package.
    """

    name: str
    """Unique; letters, digits, `-` and `_`, for it names files."""
    suite: str
    split: str
    about: str
    """What the case is, in a sentence for the docs."""
    kind: str
    """One of `KINDS`."""
    build: Callable[[Path], tuple[Material, Truth]]
    """Makes the case and tells its truth; the argument is the folder of the real logs."""
    needs: str = ""
    """Folder inside that of the real logs without which the case is skipped."""

    def __post_init__(self) -> None:
        """Check.

        Raises:
            InputError: a suite, split or kind that does not exist, or a name that is no file name.
        """
        for key, allowed in (("suite", SUITES), ("split", SPLITS), ("kind", KINDS)):
            if getattr(self, key) not in allowed:
                remedy = f"expects one of {', '.join(allowed)}"
                raise InputError(self.name, key, getattr(self, key), remedy)
        if not self.name.replace("-", "").replace("_", "").isalnum():
            raise InputError("case", "name", self.name, "expects letters, digits, - and _")


def write_case(material: Material, folder: Path) -> Path:
    """Write what a diagnosis is given: `case.json`, `robot.xml`, `logs/` and `references/`.

    Args:
        material: of the case.
        folder: new; holds the truth nowhere.
    """
    folder.mkdir(parents=True, exist_ok=True)
    robot = material.robot
    if robot.lstrip().startswith("<"):
        (folder / "robot.xml").write_text(robot)
        robot = "robot.xml"
    entry: dict[str, Any] = {"robot": robot, "logs": [], "references": []}
    for group, recordings in (("logs", material.logs), ("references", material.references)):
        (folder / group).mkdir(exist_ok=True)
        for number, recording in enumerate(recordings):
            role = "test" if group == "logs" else "reference"
            name = f"{group}/{number}_{recording.name}.parquet"
            write_recording(folder / name, recording.declared(role=role))
            entry[group].append(name)
    (folder / CASE_FILE).write_text(json.dumps(entry, indent=1) + "\n")
    return folder


def write_recording(path: Path, recording: Recording) -> None:
    """Write a recording as Parquet, its metadata as JSON under the schema key `hyperleg`.

    Args:
        path: of the file.
        recording: to write.
    """
    columns = {"t": recording.time, **recording.signals}
    table = pa.table({name: np.asarray(values, float) for name, values in columns.items()})
    content = json.dumps(dict(recording.metadata), allow_nan=False)
    pq.write_table(table.replace_schema_metadata({b"hyperleg": content.encode()}), path)


def labelled(logs: Sequence[Recording], **values: Any) -> tuple[Recording, ...]:
    """Recordings with the same metadata replaced in each.

    Args:
        logs: the recordings.
        values: of the metadata, by field.

    Returns:
        The changed copies.
    """
    return tuple(log.declared(**values) for log in logs)
