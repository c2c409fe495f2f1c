from dataclasses import replace

import numpy as np

from hyperleg_design.gap.checks.check import check_log
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.logs.sampling import Column
from hyperleg_design.report.gap.checks import checks_text


def log(**metadata):
    time = np.arange(1000) * 0.005
    signals = {}
    for joint in "abcdef":
        signals |= {
            f"position/{joint}": np.round(np.sin(5 * time), 3),
            f"position_target/{joint}": np.sin(5 * time + 0.1),
        }
    return Log("run", time, signals, Metadata(**metadata))


def test_what_a_log_can_and_cannot_show():
    lines = checks_text([check_log(log(gains=dict.fromkeys("abcdef", (20.0, 1.0))))]).splitlines()
    assert lines[0].startswith("run: 4.995 s at 200 Hz, 1000 ticks")
    assert any(
        line.startswith("  signals position (6), 200 Hz, steps of 0.001 rad, noise 0.000")
        for line in lines
    )
    assert "  shows   coulomb_friction at all 6 joints: motion reverses" in lines
    assert "  cannot  imu_bias: no gyroscope and no accelerometer" in lines
    assert lines[-1] == "  fit for a diagnosis"
    assert len([line for line in lines if line.startswith(("  shows", "  cannot"))]) == 24


def test_joints_that_show_an_effect_are_named_where_others_do_not():
    moving = log(gains=dict.fromkeys("abcdef", (20.0, 1.0)))
    still = {column: np.full(1000, 0.5) for column in ("position/f", "position_target/f")}
    partly = moving.changed(signals=moving.signals | still)
    lines = checks_text([check_log(partly)]).splitlines()
    assert "  shows   coulomb_friction at a, b, c, d and 1 more: motion reverses" in lines


def test_signals_of_unlike_joints_have_ranges_in_each_unit():
    sizes = ((5e-6, "m"), (2e-4, "rad"), (4e-4, "rad"), (0.0, "rad"))
    columns = [
        Column(f"position/{i}", 200.0, 0.0, -1.0, 1.0, step, 2 * step + 1e-7, 0.0, False, 1, unit)
        for i, (step, unit) in enumerate(sizes)
    ]
    check = replace(check_log(log()), columns=tuple(columns))
    (line,) = (one for one in checks_text([check]).splitlines() if one.startswith("  signals"))
    assert line == (
        "  signals position (4), 200 Hz, steps of 5e-06 m and 0.0002 .. 0.0004 rad, "
        "noise 1e-05 m and 1e-07 .. 0.0008 rad"
    )


def test_errors_and_remarks():
    text = checks_text([check_log(log(remarks=("the source lacks gains",)))] * 2)
    assert (
        "  error   position_target targets without gains say nothing of torques: declare `gains` "
        "in the metadata" in text
    )
    assert "  note    the source lacks gains" in text
    assert text.count("not fit for a diagnosis: mend the errors first") == 2


def test_a_log_that_shows_nothing_is_said_to_show_nothing():
    moving = log(gains=dict.fromkeys("abcdef", (20.0, 1.0)))
    resting = {name: 0 * values for name, values in moving.signals.items()}
    text = checks_text([check_log(Log("rest", moving.time, resting, moving.metadata))])
    assert text.splitlines()[-1].endswith("this log shows no effect")
