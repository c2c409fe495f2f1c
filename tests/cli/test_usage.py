"""Errors of command lines that cannot be parsed."""

from __future__ import annotations

import re

import pytest

from hyperleg_design import cli
from hyperleg_design.cli.usage import option_names


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = cli.main(list(arguments))
    out, err = capsys.readouterr()
    return code, out, err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["list", "--foo"], "--foo: hyperleg list has no such option; see hyperleg list --help"),
        (
            ["analyze", "--desing", "toe"],
            "--desing: hyperleg analyze has no such option; did you mean --design? "
            "see hyperleg analyze --help",
        ),
        # --threads is an option of other verbs, and no suggestion here
        (
            ["analyze", "--threads", "2"],
            "--threads: hyperleg analyze has no such option; see hyperleg analyze --help",
        ),
        (
            ["gap", "diagnose", "--rboot=x"],
            "--rboot: hyperleg gap diagnose has no such option; did you mean --robot? "
            "see hyperleg gap diagnose --help",
        ),
        (
            ["gap", "diagnos"],
            "verb = 'diagnos': there is none of this name; did you mean diagnose? "
            "see hyperleg gap --help",
        ),
        (["--foo"], "--foo: hyperleg has no such option; see hyperleg --help"),
        (
            ["analyze", "toe"],
            "value = 'toe': expects an option before it, as in --design toe; "
            "see hyperleg analyze --help",
        ),
        (
            ["analyze", "--variant"],
            "Missing value for argument '--variant'. Expected 1 values; "
            "see hyperleg analyze --help",
        ),
        (
            ["evaluate", "x", "--out", "y", "--swap", "lock_too"],
            "--swap = 'lock_too': did you mean lock_toe? see hyperleg evaluate --help",
        ),
        (
            ["evaluate", "x", "--out", "y", "--swap", "wheel"],
            "--swap = 'wheel': expects one of lock_toe, toe_motor_alone, toe_motor_to_ankle; "
            "see hyperleg evaluate --help",
        ),
    ],
)
def test_what_cannot_be_parsed_is_said_in_short(capsys, arguments, message):
    code, _, err = run(capsys, *arguments)
    assert code == 2
    assert err == f"hyperleg: arguments: {message}\n"


def test_all_options_of_every_verb_are_known_to_the_error(capsys):
    gap = {f"gap {name}": command for name, command in cli.gap.VERBS.items()}
    for verb, command in {**cli.VERBS, **gap}.items():
        if verb == "gap":
            continue
        _, out, _ = run(capsys, *verb.split(), "--help")
        printed = set(re.findall(r"^[│ ]{1,3}(?:-h, )?(--[a-z][a-z-]*)", out, flags=re.MULTILINE))
        assert printed <= set(option_names(command)), verb
        assert "--help" in printed
