"""The command line: one verb a job, no logic of its own."""

from __future__ import annotations

import contextlib
import io
import re
import sys
from dataclasses import dataclass
from typing import Any

import tyro

from hyperleg_design.cli import design, gap, policies
from hyperleg_design.errors import HyperlegError, InputError


@dataclass(frozen=True, kw_only=True)
class Gap:
    """Diagnose the gap between simulation and robot; `hyperleg gap --help` lists its verbs."""

    def run(self) -> None:
        """Show its verbs."""
        _parse(["gap", "--help"])


VERBS: dict[str, Any] = {
    "list": design.List,
    "build": design.Build,
    "check": design.Check,
    "analyze": design.Analyze,
    "sweep": design.Sweep,
    "compare": design.Compare,
    "study": design.Study,
    "train": policies.Train,
    "campaign": policies.Campaign,
    "evaluate": policies.Evaluate,
    "replay": policies.Replay,
    "paper": policies.Paper,
    "gap": Gap,
    "version": design.Version,
}


def _parse(arguments: list[str]) -> Any:
    """The command asked for; what is wrong with the arguments goes into one line."""
    errors = io.StringIO()
    verbs, prog, about = (
        VERBS,
        "hyperleg",
        "Design, size and compare legged robots with cooperative actuation.",
    )
    if arguments[:1] == ["gap"]:
        verbs, prog, about = (
            gap.VERBS,
            "hyperleg gap",
            "Diagnose the gap between simulation and robot: where they differ, and why.",
        )
        arguments = arguments[1:] or ["--help"]
    try:
        with contextlib.redirect_stderr(errors):
            command = tyro.extras.subcommand_cli_from_dict(
                verbs,
                prog=prog,
                description=about,
                args=arguments,
                config=(tyro.conf.FlagCreatePairsOff,),
            )
    except SystemExit as stop:
        if not stop.code:
            raise
        text = re.sub(r"[╭╮╰╯│─]+|-{3,}", " ", errors.getvalue())
        text = re.sub(r"\s+", " ", text).strip()
        text = re.sub(
            r"^(.+?) \1", r"\1", text
        )  # a box whose title is the first words of what is in it
        raise InputError("arguments", "", None, text or "see hyperleg --help") from None
    if (seed := getattr(command, "seed", None)) is not None and seed < 0:
        raise InputError("arguments", "seed", seed, "expects a whole number from 0 on")
    return command


def main(arguments: list[str] | None = None) -> int:
    """Entry point; returns the exit code: 0, or 2 on bad input."""
    try:
        _parse(list(sys.argv[1:] if arguments is None else arguments) or ["--help"]).run()
    except HyperlegError as error:
        print(f"hyperleg: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        sys.stderr.close()
        return 0
    except KeyboardInterrupt:
        print("hyperleg: stopped", file=sys.stderr)
        return 130
    except SystemExit as stop:
        return int(stop.code or 0)
    return 0
