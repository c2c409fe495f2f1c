"""What a sweep takes is said before it begins, and too much is refused."""

from __future__ import annotations

import pytest

from hyperleg_design import cli
from hyperleg_design.errors import InputError
from hyperleg_design.sweep.effort import Effort, check_effort, effort_of
from hyperleg_design.sweep.space import sweep_from_mapping
from hyperleg_design.sweep.trials.trial_plan import plan


def sweep_of(steps: int):
    gears = {"low": 5, "high": 9, "steps": steps}
    axes = {"actuators.knee.gear": gears, "toe.mass": {"values": [0.2, 0.3]}}
    variants = ["toe", "toe_locked"]
    return sweep_from_mapping({"design": "hyperleg", "variants": variants, "axes": axes})


def test_designs_and_trials_are_counted():
    sweep = sweep_of(5)
    assert effort_of(sweep, plan(sweep, [])) == Effort(designs=20, trials=0)
    wanted = plan(sweep, ["walk"], seeds=2)
    trials = int(wanted.protocols[0].trials)
    assert effort_of(sweep, wanted) == Effort(designs=20, trials=20 * 2 * trials)


def test_time_and_memory_grow_with_what_is_computed():
    small, large = Effort(1000, 0), Effort(9_000_000, 0)
    assert large.memory / small.memory == large.seconds / small.seconds == 9000
    assert Effort(1000, 100).seconds > small.seconds
    assert large.text() == ("9000000 designs: about 15 min on one processor and 18.0 GB of memory")
    assert Effort(8, 80).text() == "8 designs and 80 trials: about 24 s on one processor"


def test_more_designs_than_asked_for_are_refused():
    check_effort(Effort(100, 0), 100, "x.yaml")
    with pytest.raises(InputError, match=r"x\.yaml: designs = 101: is more than 100.*designs 101"):
        check_effort(Effort(101, 0), 100, "x.yaml")


def test_the_command_refuses_before_it_writes(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "large.yaml").write_text(
        "design: hyperleg\naxes:\n  actuators.knee.gear: {low: 5, high: 9, steps: 3000}\n"
        "  toe.mass: {low: 0.1, high: 0.5, steps: 3000}\n"
    )
    assert cli.main(["sweep", "run", "large.yaml", "--out", "out"]) == 2
    assert "--most-designs 9000000" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
