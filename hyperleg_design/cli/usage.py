"""One short error for a command line that cannot be parsed.

tyro, which parses it, suggests options of all verbs and repeats their help; here only the verb that
the user typed counts.
"""

from __future__ import annotations

import dataclasses
import difflib
import re
import typing
from collections.abc import Mapping, Sequence
from typing import Any

import tyro

from hyperleg_design.cli.arguments import option
from hyperleg_design.errors import InputError, meant

ALIKE = 0.6
"""Similarity from which one name is suggested for another (assumed; difflib's default)."""


def usage_error(arguments: Sequence[str], verbs: Mapping[str, Any], parser_text: str) -> InputError:
    """Say what is wrong with arguments that could not be parsed.

    Args:
        arguments: of the command line, without the program's name.
        verbs: commands by name; a mapping where a verb has verbs of its own.
        parser_text: what the parser printed, used for all but unknown verbs and options.

    Returns:
        An error that names the unknown verb or the first unknown option and a similar one of the
        same verb, or a value without an option, or else repeats the parser's complaint; it ends
        with where the help is.
    """
    program, rest, command = "hyperleg", list(arguments), verbs
    while isinstance(command, Mapping) and rest and not rest[0].startswith("-"):
        if rest[0] not in command:
            remedy = f"{_suggestion(rest[0], list(command))}see {program} --help"
            return InputError("arguments", "verb", rest[0], f"there is none of this name; {remedy}")
        program, command = f"{program} {rest[0]}", command[rest[0]]
        rest = rest[1:]
    known: list[str] = [] if isinstance(command, Mapping) else option_names(command)
    typed = [word.split("=")[0].replace("_", "-") for word in rest if word.startswith("--")]
    unknown = next((word for word in typed if word not in known), None)
    if unknown is not None:
        remedy = f"{_suggestion(unknown, known)}see {program} --help"
        return InputError("arguments", unknown, None, f"{program} has no such option; {remedy}")
    complaint = _complaint(parser_text)
    stray = re.match(r"Unrecognized options?: (?!-)(\S+)", complaint)
    if stray:
        example = f", as in --design {stray[1]}" if "--design" in known else ""
        remedy = f"expects an option before it{example}; see {program} --help"
        return InputError("arguments", "value", stray[1], remedy)
    choice = re.match(
        r"invalid choice '(.*)' for argument '(\S+)'. Expected one of \((.*)\)", complaint
    )
    if choice:
        names = [name for name in re.findall(r"'(.*?)'", choice[3]) if name]
        remedy = meant(choice[1], names, f"expects one of {', '.join(names)};")
        return InputError("arguments", choice[2], choice[1], f"{remedy} see {program} --help")
    return InputError("arguments", "", None, f"{complaint}; see {program} --help")


def option_names(command: Any) -> list[str]:
    """List the options of a verb.

    Args:
        command: a dataclass whose fields are options.

    Returns:
        The options as a user types them, such as `--set-file`, aliases included.
    """
    hints = typing.get_type_hints(command, include_extras=True)
    options = ["--help"]
    for field in dataclasses.fields(command):
        marks = getattr(hints[field.name], "__metadata__", ())
        if tyro.conf.Positional in marks:
            continue
        named = [mark for mark in marks if hasattr(mark, "aliases")]  # by tyro.conf.arg
        options.append(option(next((mark.name for mark in named if mark.name), field.name)))
        options += [alias for mark in named for alias in mark.aliases or ()]
    return options


def _suggestion(name: str, names: Sequence[str]) -> str:
    bare = {known.strip("-"): known for known in names}  # dashes make all options alike
    near = difflib.get_close_matches(name.strip("-"), list(bare), n=1, cutoff=ALIKE)
    return f"did you mean {bare[near[0]]}? " if near else ""


def _complaint(text: str) -> str:
    """The parser's first words, without its frame, its title and its pointers to the help."""
    bare = re.sub(r"[╭╮╰╯│─]|-{3,}", " ", text)  # a frame, or dashes where there is no terminal
    title, *lines = [line for line in bare.splitlines() if line.strip()] or [""]
    words = " ".join(" ".join(lines or [title]).split())
    words = re.split(r"Perhaps you meant|Argument helptext|For full helptext", words)[0]
    return words.strip(" .:") or "they cannot be parsed"
