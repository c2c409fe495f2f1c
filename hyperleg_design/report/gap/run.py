"""The run of a diagnosis, for commands that go on from it."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass

from hyperleg_design.errors import InputError


@dataclass(frozen=True)
class Run:
    """Paths of a run, as its user gave them; what is unknown stands as a word in capitals."""

    robot: str = "ROBOT"
    """Design, MJCF or URDF."""
    logs: tuple[str, ...] = ("LOG",)
    """That were diagnosed."""
    out: str = "FOLDER"
    """Folder of the diagnosis."""

    def __post_init__(self) -> None:
        for field in ("robot", "logs", "out"):
            if not getattr(self, field):
                raise InputError("run", field, getattr(self, field), "expects a path")

    def command(self, verb: str, *arguments: str) -> str:
        """Write a command of `hyperleg gap`.

        Args:
            verb: of the command.
            arguments: behind it, with spaces and quotes as they are.

        Returns:
            The command, quoted for a shell.
        """
        return shlex.join(("hyperleg", "gap", verb, *arguments))

    @property
    def named_robot(self) -> Sequence[str]:
        """Arguments that name the robot."""
        return ("--robot", self.robot)
