"""The command line: one verb a job, no logic of its own."""

from __future__ import annotations

import contextlib
import io
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Union

import tyro

from hyperleg_design import __version__
from hyperleg_design.cli import design, gap, look, policies, search, validate, variants
from hyperleg_design.cli.arguments import check_bounds
from hyperleg_design.cli.usage import usage_error
from hyperleg_design.errors import HyperlegError
from hyperleg_design.robot.motors import use_folder

ABOUT = (
    "Design, size and compare legged robots with cooperative actuation. "
    "--version prints the version; --tyro-print-completion bash (or zsh) prints a script for the "
    "shell that completes verbs and options."
)


def _union(verbs: Mapping[str, Any]) -> Any:
    """Type of a command that is one of several verbs, each under its name."""
    named = (Annotated[command, tyro.conf.subcommand(name)] for name, command in verbs.items())
    return Union[tuple(named)]  # noqa: UP007  # the members are known only when this runs


@dataclass(frozen=True, kw_only=True)
class Gap:
    """Diagnose the gap between simulation and robot; `hyperleg gap --help` lists its verbs."""

    verb: Annotated[_union(gap.VERBS), tyro.conf.arg(name="")]  # type: ignore[valid-type]
    """What to do."""

    def run(self) -> None:
        """Run the verb of `hyperleg gap` that was chosen."""
        self.verb.run()


VERBS: dict[str, Any] = {
    "list": design.List,
    "build": design.Build,
    "check": design.Check,
    "import": design.Import,
    "analyze": design.Analyze,
    "sweep": design.Sweep,
    "search": search.Search,
    "compare": design.Compare,
    "study": design.Study,
    "train": policies.Train,
    "campaign": policies.Campaign,
    "evaluate": policies.Evaluate,
    "robustness": policies.Robustness,
    "variants": variants.Variants,
    "view": look.View,
    "video": look.Video,
    "paper": policies.Paper,
    "gap": Gap,
    "validate": validate.Validate,
    "version": design.Version,
}
"""Commands by name: dataclasses whose fields are options, with a method `run`."""


def _parse(arguments: list[str]) -> Any:
    """Parse the arguments to the command that they name.

    Raises:
        InputError: the arguments are wrong; one line says how.
        SystemExit: help or a completion script was printed.
    """
    if arguments in ([], ["gap"]):
        arguments = [*arguments, "--help"]
    errors = io.StringIO()
    try:
        with contextlib.redirect_stderr(errors):
            command = tyro.cli(
                _union(VERBS),
                prog="hyperleg",
                description=ABOUT,
                args=arguments,
                config=(tyro.conf.FlagCreatePairsOff,),
            )
    except SystemExit as stop:
        if not stop.code:
            raise
        verbs = VERBS | {"gap": gap.VERBS}
        raise usage_error(arguments, verbs, errors.getvalue()) from None
    check_bounds(command)
    if folder := getattr(getattr(command, "verb", command), "motors", None):
        use_folder(folder)
    return command


def main(arguments: list[str] | None = None) -> int:
    """Run the command line.

    Args:
        arguments: without the program's name; the process's own by default.

    Returns:
        The exit code: 0 where all went well, 2 on bad input, 3 where a training or campaign was
        stopped before it was done, 130 where the user interrupted.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    if given == ["--version"]:
        print(f"hyperleg {__version__}")
        return 0
    try:
        _parse(given).run()
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
