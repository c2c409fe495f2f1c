"""Folders of a diagnosis and of planned experiments: whole, or not there."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.gap.logs.log import Log, write_log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.report.gap.report import diagnose_to_folder, excite_to_folder

PENDULUM = """
<mujoco model="pendulum"><worldbody><body name="arm" pos="0 0 1">
<joint name="swing" axis="0 1 0" damping="0.02" armature="0.003"/>
<inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.0006 0.0006 0.0001"/></body></worldbody>
<actuator><motor name="servo" joint="swing" ctrlrange="-3 3"/></actuator></mujoco>
"""
INERTIA = 0.003 + 0.0006 + 0.5 * 0.1**2
"""Of the arm and the rotor about the joint [kg m^2]."""


def swing(name: str, dry: float, seed: int) -> Log:
    """Swings of a pendulum with Coulomb friction [Nm], in closed form."""
    time, rng = np.arange(1600) * 0.005, np.random.default_rng(seed)
    waves = [(0.5, 2.0, 0.0), (0.2, 5.1, 1.0), (0.1, 9.3, seed)]
    angle = sum(a * np.sin(w * time + p) for a, w, p in waves)
    speed = sum(a * w * np.cos(w * time + p) for a, w, p in waves)
    acceleration = -sum(a * w**2 * np.sin(w * time + p) for a, w, p in waves)
    torque = INERTIA * acceleration + 0.5 * 9.81 * 0.1 * np.sin(angle)
    torque += 0.02 * speed + dry * np.tanh(speed / 0.02)
    torque += 0.005 * rng.normal(size=len(time))
    signals = {"position/swing": angle, "velocity/swing": speed, "motor_torque/servo": torque}
    return Log(name, time, signals, Metadata(base="fixed"))


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> Path:
    """The robot's file, and logs of a dry and of a healthy joint."""
    folder = tmp_path_factory.mktemp("pendulum")
    (folder / "pendulum.xml").write_text(PENDULUM)
    write_log(folder / "dry.parquet", swing("dry", 0.3, 1))
    write_log(folder / "healthy.parquet", swing("healthy", 0.0, 9))
    return folder


@pytest.fixture(scope="module")
def diagnosed(files):
    """Answer and page of one diagnosis."""
    robot, healthy = str(files / "pendulum.xml"), files / "healthy.parquet"
    return diagnose_to_folder(robot, [files / "dry.parquet"], [healthy], files / "out", threads=1)


def test_the_file_is_the_answer_and_the_answer_is_right(diagnosed):
    answer, page = diagnosed
    assert json.loads((page.parent / "diagnosis.json").read_text()) == answer
    assert answer["verdict"] == "explained"
    (cause,) = answer["causes"]
    assert cause["effect"] == "coulomb_friction"
    assert cause["parameters"]["torque"]["value"] == pytest.approx(0.3, rel=0.1)


def test_the_page_stands_beside_its_figures(diagnosed):
    _, page = diagnosed
    assert page.name == "index.html"
    text = page.read_text()
    figures = list(page.parent.rglob("*.png"))
    assert figures
    assert all(path.relative_to(page.parent).as_posix() in text for path in figures)


def test_nothing_is_written_of_logs_or_robots_that_cannot_be_read(files, tmp_path):
    with pytest.raises(InputError, match="none"):
        diagnose_to_folder(str(files / "pendulum.xml"), [files / "none"], [], tmp_path / "out")
    with pytest.raises(InputError, match=r"robot\.xml"):
        diagnose_to_folder(
            str(files / "robot.xml"), [files / "healthy.parquet"], [], tmp_path / "out"
        )
    assert not (tmp_path / "out").exists()


def test_somebody_elses_folder_is_refused_before_any_work(files, tmp_path):
    (tmp_path / "thesis.txt").write_text("years of work")
    for write in (
        lambda: diagnose_to_folder("no robot", ["no log"], [], tmp_path),
        lambda: excite_to_folder("no robot", tmp_path),
    ):
        with pytest.raises(OutputError, match=str(tmp_path)):
            write()
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


@pytest.mark.slow
def test_planned_experiments_lie_beside_the_text_that_is_returned(files, tmp_path):
    text = excite_to_folder(str(files / "pendulum.xml"), tmp_path / "plan", rate=100.0)
    names = {path.name for path in (tmp_path / "plan").iterdir()}
    assert any(name.endswith(".png") for name in names)
    plan = json.loads((tmp_path / "plan" / "plan.json").read_text())
    assert all(motion["name"] in text for motion in plan["motions"])
