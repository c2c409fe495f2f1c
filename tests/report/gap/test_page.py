from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hyperleg_design.gap.inference.detectors.sinking import SINKS
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.report.gap import page as gap_page
from hyperleg_design.report.gap.page import write_gap_page

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


def written(folder: Path, told: dict, signals) -> str:
    return write_gap_page(folder, told, signals).read_text()


def test_a_named_cause_is_on_the_page_with_its_figures(tmp_path: Path, signals) -> None:
    rival = {**CAUSE, "effect": "backlash", "parameters": {}, "closed": 0.4, "probability": 0.001}
    text = written(tmp_path, diagnosis("explained", causes=[CAUSE], rivals=[rival]), signals)
    assert "<h1>Coulomb friction at swing (torque 0.2 Nm) explains the gap.</h1>" in text
    assert "93 % of the gap beyond the noise floor is gone" in text
    assert "(95 % interval 90 to 95 %)" in text
    assert "0.17 to 0.21" in text
    assert "<b>Backlash</b><br>swing" in text
    assert "&lt; 0.01" in text
    assert "hyperleg gap apply" in text
    for name in ("trace-1.png", "speed-1.png"):
        assert f"figures/{name}" in text
        assert (tmp_path / "figures" / name).read_bytes().startswith(b"\x89PNG")


def test_a_phone_and_a_dark_scheme_are_served(tmp_path: Path, signals) -> None:
    text = written(tmp_path, diagnosis("explained", causes=[CAUSE]), signals)
    assert 'name="viewport" content="width=device-width' in text
    assert "prefers-color-scheme: dark" in text
    assert "max-width: 760px" in text


def test_what_to_do_next_is_told(tmp_path: Path, signals) -> None:
    pair = [
        [
            {"effect": "payload", "location": "arm"},
            {"effect": "torque_constant", "location": "swing"},
        ]
    ]
    trial = {
        "name": "hang a known mass",
        "do": "weigh it first",
        "minutes": 5,
        "separates": ["payload at arm", "torque_constant at swing"],
    }
    told = diagnosis("ambiguous", causes=[CAUSE], equivalent=pair, separating_experiment=trial)
    text = written(tmp_path, told, signals)
    assert "and either payload at arm or torque constant at swing: these logs cannot tell" in text
    assert "Hang a known mass: weigh it first (5 minutes)." in text


@pytest.mark.parametrize("verdict", ["none", "unknown"])
def test_without_a_cause_nothing_is_claimed(verdict: str, tmp_path: Path, signals) -> None:
    text = written(tmp_path, diagnosis(verdict, where=[]), signals)
    assert f'class="verdict {verdict}"' in text
    assert "<h2>Causes</h2>" not in text
    assert "hyperleg gap apply" not in text
    assert "<svg" not in text


def test_what_is_left_of_an_unknown_gap_follows_the_verdict(tmp_path: Path, signals) -> None:
    shape = {
        "shape": "friction_over_position",
        "location": "swing",
        "says": "swing: friction that depends on where the joint is",
        "closed_beyond": 0.9,
    }
    text = written(tmp_path, diagnosis("unknown", residual_shape=[shape]), signals)
    assert '<p class="lead">Left at swing: friction that depends on where the joint is.</p>' in text


def test_a_remainder_and_what_references_lack_stand_below_the_verdict(
    tmp_path: Path, signals
) -> None:
    told = diagnosis(
        "explained",
        causes=[CAUSE],
        remainder=0.18,
        lacks={"verdict": "explained", "causes": [CAUSE]},
        reference_differences=[{"log": "monday", **CAUSE}],
    )
    text = written(tmp_path, told, signals)
    assert "The reference log monday differs from the others by Coulomb friction" in text
    assert "18 % of the gap is left that no effect of the catalogue explains." in text
    assert "The reference logs already show what the model lacks: Coulomb friction" in text


def test_every_foot_that_sinks_stands_below_the_causes(tmp_path: Path, signals) -> None:
    feet = [
        {"shape": SINKS, "location": foot, "says": "sinks by 4 mm", "closed_beyond": 0.9}
        for foot in ("front", "middle", "rear")
    ]
    text = written(tmp_path, diagnosis("explained", causes=[CAUSE], residual_shape=feet), signals)
    causes = text[: text.index("What is left")]
    for foot in feet:
        assert f"{foot['location']} sinks by 4 mm." in causes


def test_the_robot_is_coloured_by_shares_of_the_whole_gap_and_regimes_are_of_their_own_place(
    tmp_path: Path, signals, monkeypatch
) -> None:
    drawn, draw = [], gap_page.robot_svg
    monkeypatch.setattr(
        gap_page,
        "robot_svg",
        lambda subject, shares: drawn.append(shares) or draw(subject, shares),
    )
    where = [
        {"location": "swing", "kind": "joint", "regime": "all", "share": 0.4},
        {"location": "swing", "kind": "joint", "regime": "forward", "share": 0.63},
        {"location": "robot", "kind": "robot", "regime": "all", "share": 0.6},
    ]
    text = written(tmp_path, diagnosis("unknown", where=where), signals)
    assert drawn == [{"swing": 0.4, "robot": 0.6}]
    assert "63 % of its own" in text
    assert "40 % of its own" not in text
    assert "Share of the gap at each joint; robot 60 %." in text
