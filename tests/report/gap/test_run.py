from __future__ import annotations

import shlex

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.report.gap.run import Run


def test_a_command_is_what_a_shell_splits_again() -> None:
    run = Run("an arm's.xml", ("one log.csv",), "out")
    command = run.command("apply", run.out, *run.named_robot)
    assert shlex.split(command) == ["hyperleg", "gap", "apply", "out", "--robot", "an arm's.xml"]


@pytest.mark.parametrize("field", ["robot", "logs", "out"])
def test_a_run_has_paths(field: str) -> None:
    with pytest.raises(InputError):
        Run(**{field: ()})
