"""A built robot takes its own motors along."""

from __future__ import annotations

import pytest

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.robot import motors
from hyperleg_design.robot.build import build
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot


def test_a_robot_takes_motors_of_ones_own_along(tmp_path, monkeypatch):
    monkeypatch.setenv(motors.FOLDERS, "")
    text = (resources.content_folder("motors") / "RI60.yaml").read_text().replace("RI60", "Mine")
    (tmp_path / "Mine.yaml").write_text(text)
    motors.use_folder(tmp_path)
    changes = {"actuators.knee.motor": "Mine", "reference.toe_motor": "Mine"}
    folder = build(load_design("toe", overrides=changes), tmp_path / "out" / "robot")
    monkeypatch.setenv(motors.FOLDERS, "")
    monkeypatch.chdir(tmp_path / "out")
    design = load_robot("robot/design.yaml")
    assert str(design["actuators.knee.motor"]) == "robot/own_motors/Mine.yaml"
    again = build(design, tmp_path / "again")
    for name in ("design.yaml", "own_motors/Mine.yaml", "toe.xml"):
        assert (again / name).read_bytes() == (folder / name).read_bytes()


def test_two_motors_of_one_name_cannot_go_along(tmp_path):
    text = (resources.content_folder("motors") / "RI60.yaml").read_text().replace("RI60", "Mine")
    for name, own in (("a", text), ("b", text + "\n")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "Mine.yaml").write_text(own)
    changes = {
        f"actuators.{p}.motor": str(tmp_path / n / "Mine.yaml")
        for p, n in (("knee", "a"), ("toe", "b"))
    }
    with pytest.raises(InputError, match="another motor of the design"):
        build(load_design("toe", overrides=changes), tmp_path / "out")
    assert not (tmp_path / "out").exists()
