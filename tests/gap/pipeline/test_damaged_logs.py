"""Damaged logs of a healthy robot: a clear error, or an answer that says less; never a confident
wrong cause.
"""

from __future__ import annotations

import diagnosed
import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.checks.check import check_log
from hyperleg_design.gap.logs.log import write_log
from hyperleg_design.gap.pipeline.diagnose import diagnose


@pytest.fixture(scope="module")
def healthy():
    return diagnosed.run("healthy", 5)


def gaps(signals, time):
    """One row in ten without anything, in bursts."""
    lost = (time % 1.0) < 0.1
    return {c: np.where(lost, np.nan, v) for c, v in signals.items()}


def some_unknown(signals, time):
    """A channel that comes and goes."""
    return {
        **signals,
        "motor_torque/m_front": np.where(
            (time % 0.4) < 0.1, np.nan, signals["motor_torque/m_front"]
        ),
    }


def no_velocities(signals, time):
    return {c: v for c, v in signals.items() if not c.startswith("velocity/")}


def two_rates(signals, time):
    """Torques at a fifth of the rate, empty between."""
    rare = np.arange(len(time)) % 5 != 0
    return {
        c: np.where(rare, np.nan, v) if c.startswith("motor_torque/") else v
        for c, v in signals.items()
    }


def saturated(signals, time):
    """A torque sensor that ends at six tenths of what it should show."""
    column = "motor_torque/m_front"
    most = 0.6 * np.abs(signals[column]).max()
    return {**signals, column: np.clip(signals[column], -most, most)}


def flat_velocity(signals, time):
    return {**signals, "velocity/knee": np.zeros(len(time))}


def frozen_position(signals, time):
    """An encoder that sticks for two seconds and comes back with a jump."""
    values = signals["position/knee"].copy()
    stuck = (time > 4) & (time < 6)
    values[stuck] = values[stuck][0]
    return {**signals, "position/knee": values}


def swapped(signals, time):
    return {
        **signals,
        "position/hip": signals["position/knee"],
        "position/knee": signals["position/hip"],
    }


def degrees(signals, time):
    return {c: np.degrees(v) if c.startswith("velocity/") else v for c, v in signals.items()}


def coarse(signals, time):
    """Positions in steps of a third of a degree."""
    step = np.radians(1 / 3)
    return {
        c: np.round(v / step) * step if c.startswith("position/") else v for c, v in signals.items()
    }


REFUSED = (flat_velocity, swapped, degrees)
ENDURED = (gaps, some_unknown, no_velocities, two_rates, coarse)
WRONG = (saturated, frozen_position)
"""Logs that are wrong in themselves: what is wrong may be told, but no cause elsewhere."""


@pytest.mark.parametrize("damage", REFUSED)
def test_what_cannot_be_right_is_refused(robot_files, healthy, damage):
    with pytest.raises(InputError, match=r"velocity|position"):
        diagnose(
            robot_files["coupled"],
            [healthy.changed(signals=damage(dict(healthy.signals), healthy.time))],
        )


@pytest.mark.parametrize("damage", ENDURED)
def test_what_is_lacking_names_no_cause(robot_files, healthy, damage):
    log = healthy.changed(signals=damage(dict(healthy.signals), healthy.time))
    assert diagnose(robot_files["coupled"], [log]).verdict in ("none", "unknown")


@pytest.mark.parametrize("damage", WRONG)
def test_broken_sensors_are_told_or_lead_nowhere(robot_files, healthy, damage):
    log = healthy.changed(signals=damage(dict(healthy.signals), healthy.time))
    told = [
        f"{f.signal} {f.what}"
        for f in check_log(log).findings
        if f.severity in ("warning", "error")
    ]
    found = diagnose(robot_files["coupled"], [log])
    if found.verdict in ("explained", "ambiguous"):
        assert told
        assert found.causes[0].effect == "torque_saturation"
    assert found.verdict != "none" or told


def test_an_empty_and_a_short_log(robot_files, healthy, tmp_path):
    with pytest.raises(InputError):
        diagnose(robot_files["coupled"], [healthy.part(slice(0, 20))])
    path = write_log(tmp_path / "log.parquet", healthy)
    path.write_bytes(path.read_bytes()[:2000])
    from hyperleg_design.gap.logs.log import read_log

    with pytest.raises(InputError, match=r"log\.parquet"):
        read_log(path)


def test_a_log_of_another_robot(robot_files, healthy):
    with pytest.raises(InputError, match="robot"):
        diagnose(robot_files["arm"], [healthy])
