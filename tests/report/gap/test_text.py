import numpy as np

from hyperleg_design.gap.checks.check import check_log
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.report.gap.text import checks_text


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
        line.startswith("  signals position (6), 200 Hz, steps of 0.001, noise 0.000")
        for line in lines
    )
    assert "  shows   coulomb_friction at a, b, c, d and 2 more: motion reverses" in lines
    assert "  cannot  imu_bias: no gyroscope and no accelerometer" in lines
    assert lines[-1] == "  fit for a diagnosis"
    assert len([line for line in lines if line.startswith(("  shows", "  cannot"))]) == 24


def test_errors_and_remarks():
    text = checks_text([check_log(log(remarks=("the source lacks gains",)))] * 2)
    assert (
        "  error   position_target targets without gains say nothing of torques: declare `gains` "
        "in the metadata" in text
    )
    assert "  note    the source lacks gains" in text
    assert text.count("not fit for a diagnosis: mend the errors first") == 2
