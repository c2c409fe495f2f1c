"""Paths of motors count from the working directory, or from the file that names them."""

from __future__ import annotations

import yaml

from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.robot.parameters.motor_paths import with_motor_paths
from hyperleg_design.sweep.space import load_sweep
from tests.robot.tree_files import leg_file

MOTOR = {
    "name": "mine",
    "kind": "flat",
    "convention": {"resistance": "line_line", "current": "dc"},
    "constants": {
        "nominal_voltage": 48.0,
        "no_load_speed_rpm": 3000,
        "peak_torque": 4.2,
        "rated_torque": 1.4,
        "torque_constant": 0.14,
        "resistance": 0.2,
        "rotor_inertia_g_cm2": 400,
        "mass_g": 420,
        "pole_pairs": 20,
    },
}


def test_a_robot_in_a_folder_brings_its_motor_along(tmp_path, monkeypatch):
    """Design, motor and sweep lie in a folder of their own, and the command runs elsewhere."""
    folder = tmp_path / "robot"
    (folder / "motors").mkdir(parents=True)
    (folder / "motors" / "mine.yaml").write_text(yaml.safe_dump(MOTOR))
    data = leg_file()
    data["actuators"]["knee"]["motor"] = {"value": "motors/mine.yaml", "label": "user"}
    data["actuators"]["hip"]["motor"] = "motors/mine.yaml"
    (folder / "leg.yaml").write_text(yaml.safe_dump(data))
    (folder / "sweep.yaml").write_text(
        "design: leg.yaml\naxes: {actuators.knee.motor: {values: [RI70, motors/mine.yaml]}}\n"
    )
    monkeypatch.chdir(tmp_path)
    assert motor_arrays(load_robot("robot/leg.yaml")).peak_torque.tolist() == [4.2, 4.2]
    sweep = load_sweep("robot/sweep.yaml")
    assert sweep.base.name == "leg"
    assert list(sweep.axes[0].levels) == ["RI70", "robot/motors/mine.yaml"]


def test_names_and_faulty_values_pass_unchanged(tmp_path):
    data = {
        "name": "leg",
        "actuators": {"a": {"motor": "RI70"}, "b": 3, "c": {"motor": 4}, "d": {"gear": 5}},
        "reference": ["RI70"],
    }
    assert with_motor_paths(data, tmp_path) == data
