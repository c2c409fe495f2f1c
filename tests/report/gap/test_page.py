from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.report.gap import figures as gap_figures
from hyperleg_design.report.gap.page import cause_text, write_gap_page
from hyperleg_design.report.gap.text import diagnosis_text

PENDULUM = """
<mujoco><worldbody><body name="arm"><joint name="swing" axis="0 1 0"/>
<inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.001 0.001 0.001"/></body></worldbody>
<actuator><motor name="servo" joint="swing"/></actuator></mujoco>
"""
CAUSE = {
    "effect": "coulomb_friction",
    "location": "swing",
    "probability": 0.97,
    "closed": 0.93,
    "parameters": {"torque": {"value": 0.2, "low": 0.17, "high": 0.21, "unit": "Nm"}},
}
GAP = {
    "before": 0.2,
    "after": 0.02,
    "floor": 0.01,
    "closed": 0.93,
    "closed_interval": [0.9, 0.95],
    "unit": "Nm",
}


def diagnosis(verdict: str, **changes: object) -> dict:
    where = [{"location": "swing", "kind": "joint", "regime": "all", "share": 1.0}]
    plain = {
        "schema": 1,
        "verdict": verdict,
        "gap": GAP,
        "where": where,
        "causes": [],
        "rivals": [],
        "equivalent": [],
        "separating_experiment": None,
    }
    return plain | changes


@pytest.fixture(scope="module")
def signals(tmp_path_factory: pytest.TempPathFactory):
    path = tmp_path_factory.mktemp("pendulum") / "pendulum.xml"
    path.write_text(PENDULUM)
    time = np.arange(1200) * 0.005
    position = 0.5 * np.sin(2 * time)
    log = Log(
        "run",
        time,
        {"position/swing": position, "motor_torque/swing": 0.2 * np.sign(np.cos(2 * time))},
        Metadata(base="fixed"),
    )
    return [condition(log, load_subject(path, [log]))]


def test_a_named_cause_is_on_the_page_with_its_figures(tmp_path: Path, signals) -> None:
    told = diagnosis(
        "explained", causes=[CAUSE], rivals=[{**CAUSE, "effect": "backlash", "parameters": {}}]
    )
    text = write_gap_page(tmp_path, told, signals).read_text()
    assert "coulomb_friction" in text
    assert "0.17 .. 0.21" in text
    assert "93 %" in text
    for name in ("where.png", "trace-1.png", "waterfall.png", "rivals.png"):
        assert f"figures/{name}" in text
        assert (tmp_path / "figures" / name).read_bytes().startswith(b"\x89PNG")


def test_what_to_do_next_is_told(tmp_path: Path, signals) -> None:
    pair = [
        [
            {"effect": "payload", "location": "arm"},
            {"effect": "torque_constant", "location": "swing"},
        ]
    ]
    told = diagnosis(
        "ambiguous",
        causes=[CAUSE],
        equivalent=pair,
        separating_experiment={"experiment": "hang a known mass", "why": "two loads"},
    )
    text = write_gap_page(tmp_path, told, signals).read_text()
    assert "payload at arm, torque_constant at swing" in text
    assert "hang a known mass" in text


@pytest.mark.parametrize("verdict", ["none", "unknown"])
def test_without_a_cause_nothing_is_claimed(verdict: str, tmp_path: Path, signals) -> None:
    text = write_gap_page(tmp_path, diagnosis(verdict, where=[]), signals).read_text()
    assert f"Verdict: {verdict}" in text
    assert "waterfall" not in text


def test_joints_that_chatter_come_first(tmp_path: Path, signals) -> None:
    shape = {
        "shape": "chatter",
        "location": "swing",
        "says": "swings to and fro by 2 rad/s at 60 Hz",
        "closed_beyond": 0.0,
        "gain": 0.0,
    }
    told = diagnosis("unknown", residual_shape=[shape])
    assert (
        "What is left first of all: swing chatters"
        in write_gap_page(tmp_path, told, signals).read_text()
    )
    assert (
        "  left: chatter at swing: swings to and fro by 2 rad/s at 60 Hz"
        in diagnosis_text(told).splitlines()
    )


def test_what_a_joint_shows_at_rest_is_told_and_no_gap_is_said_to_close(
    tmp_path: Path, signals
) -> None:
    rest = {"location": "swing", "torque": 0.3, "says": "swing stays where it is: it sticks"}
    told = diagnosis("explained", causes=[CAUSE], at_rest=[rest])
    told["gap"] = {**told["gap"], "closed": 0.0}
    text = write_gap_page(tmp_path, told, signals).read_text()
    assert "swing stays where it is: it sticks." in text
    assert "closes the gap" not in text
    assert (
        "  at rest, which is in no balance: swing stays where it is: it sticks"
        in diagnosis_text(told).splitlines()
    )


def test_causes_read_as_a_sentence() -> None:
    assert cause_text(CAUSE) == "coulomb_friction at swing (torque 0.2 Nm, 0.17 .. 0.21)"


def test_the_robot_is_coloured_by_shares_of_the_whole_gap_and_regimes_are_of_their_own_place(
    tmp_path: Path, signals, monkeypatch
) -> None:
    drawn, draw = [], gap_figures.robot_figure
    monkeypatch.setattr(
        gap_figures,
        "robot_figure",
        lambda subject, shares: drawn.append(shares) or draw(subject, shares),
    )
    where = [
        {"location": "swing", "kind": "joint", "regime": "all", "share": 0.4},
        {"location": "swing", "kind": "joint", "regime": "forward", "share": 0.63},
    ]
    text = write_gap_page(tmp_path, diagnosis("unknown", where=where), signals).read_text()
    assert drawn == [{"swing": 0.4}]
    assert "63 % of its own" in text
    assert "40 % of its own" not in text
