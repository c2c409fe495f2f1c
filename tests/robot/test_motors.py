from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
import yaml

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.robot import motors
from hyperleg_design.robot.check import check_file
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.motors import (
    catalogue,
    find_motor,
    gather,
    motor_arrays,
)
from hyperleg_design.robot.names import MOTORS

MOTORS_OF_PAPER = {
    "U10": (300.0, 5.04, 3.54, 84.7),
    "RI70": (327.2, 2.68, 33.44, 9.78),
    "RI60": (366.0, 1.63, 124.57, 2.94),
}
"""No-load speed, peak torque and power constant of Table I; stall torque that follows."""


@pytest.mark.parametrize("name", MOTORS_OF_PAPER)
def test_table_one(name):
    motor = find_motor(name)
    speed, peak, cp, stall = MOTORS_OF_PAPER[name]
    assert (motor.no_load_speed(), motor.peak_torque(), motor.power_constant()) == (speed, peak, cp)
    assert motor.stall_torque() == pytest.approx(stall, abs=0.05 if stall > 10 else 0.005)


@pytest.mark.parametrize(
    ("name", "cp", "mass", "rotor", "rated"),
    [("RI70", 24.7, 0.2704, 92.15e-7, 0.94), ("RI60", 90.0, 0.1559, 33.05e-7, 0.57)],
)
def test_vendor_constants(name, cp, mass, rotor, rated):
    motor = find_motor(name)
    assert motor.power_constant("vendor") == pytest.approx(cp, abs=0.05)
    assert (motor.mass, motor.rated_torque) == (mass, rated)
    assert motor.rotor_inertia == pytest.approx(rotor, rel=1e-12)


def test_the_papers_cp_is_that_of_the_back_emf():
    for name, kt in (("RI70", 0.1118), ("RI60", 0.0850)):
        motor = find_motor(name)
        assert motor.line_resistance / kt**2 == pytest.approx(
            motor.power_constant("paper"), rel=1e-3
        )


def test_the_catalogue_is_a_real_choice():
    assert len(catalogue()) >= 11
    others = set(catalogue()) - set(MOTORS_OF_PAPER)
    assert len({catalogue()[n].power_constant("vendor") for n in others}) == len(others)


@pytest.mark.parametrize("motor", catalogue().values(), ids=catalogue())
def test_every_motor_makes_sense(motor):
    for constants in ("paper", "vendor"):
        cp, stall, peak, free = (
            f(constants)
            for f in (
                motor.power_constant,
                motor.stall_torque,
                motor.peak_torque,
                motor.no_load_speed,
            )
        )
        assert stall == pytest.approx(free / cp, rel=1e-12)
        assert motor.motor_constant(constants) ** -2 == pytest.approx(cp, rel=1e-12)
        corner = motor.corner_speed(constants)
        if corner:  # the line passes through the corner
            assert stall * (1 - corner / free) == pytest.approx(peak, rel=1e-9)
        assert motor.rated_heat(constants) == pytest.approx(cp * motor.rated_torque**2, rel=1e-12)
    assert 0.05 < motor.mass < 3
    for name, constant in motor.constants.items():
        assert constant.source, name


def test_motor_arrays_follow_the_motors(hyperleg):
    batch = hyperleg.with_values(
        {
            "actuators.knee.motor": np.array(["RI70", "RI80"]),
            "electrical.voltage_ratio": np.array([1.0, 0.5]),
        }
    )
    arrays = motor_arrays(batch)
    assert arrays.mass.shape == (2, len(MOTORS))
    assert arrays.mass[1, 3] == find_motor("RI80").mass
    for name in ("no_load_speed", "stall_torque"):
        np.testing.assert_allclose(
            getattr(arrays, name)[1, :3], 0.5 * getattr(arrays, name)[0, :3], rtol=1e-15
        )
    np.testing.assert_array_equal(
        arrays.peak_torque[0, [0, 3, 4, 5, 6]], [5.04, 2.68, 1.63, 1.63, 1.63]
    )
    for index in range(2):
        one = motor_arrays(batch.take(index))
        for name in vars(arrays):
            np.testing.assert_array_equal(getattr(one, name), getattr(arrays, name)[index])


def test_gather_keeps_the_shape():
    assert gather("RI70", lambda m: m.mass).shape == ()
    assert gather(np.array(["RI60", "RI70", "RI60"]), lambda m: m.mass).tolist() == [
        0.1559,
        0.2704,
        0.1559,
    ]


def test_an_unknown_motor_names_the_nearest():
    with pytest.raises(InputError, match=r"RI7O.*no such motor; did you mean RI70"):
        find_motor("RI7O")


def test_a_broken_catalogue_names_its_file(write, tmp_path, monkeypatch):
    for kind in ("descriptions", "motors"):
        (tmp_path / kind).mkdir()
    write("motors/RI70.yaml", "name: RI70\n")
    monkeypatch.setenv("HYPERLEG_HOME", str(tmp_path))
    with pytest.raises(InputError, match=r"motors/RI70\.yaml: kind"):
        catalogue()


def test_a_design_with_a_broken_motor_names_the_motors_file(own_folder):
    broken = own_folder / "Broken.yaml"
    broken.write_text("kind: stepper\nconstants: {}\nconvention: {}\n")
    with pytest.raises(InputError, match=rf"^{own_folder}/Broken\.yaml: "):
        load_design("hyperleg", overrides={"actuators.knee.motor": str(broken)})


@pytest.fixture
def own_folder(tmp_path, monkeypatch):
    """A folder with one motor of the user's: RI70 under another name, twice as strong."""
    monkeypatch.setenv(motors.FOLDERS, "")
    source = resources.find("motors", "RI70").read_text()
    folder = tmp_path / "mine"
    folder.mkdir()
    data = yaml.safe_load(source) | {"name": "Mine"}
    data["constants"]["peak_torque"]["value"] *= 2
    data.pop("presets", None)
    (folder / "Mine.yaml").write_text(yaml.safe_dump(data))
    return folder


def test_motors_of_a_folder_are_in_the_catalogue_of_this_and_other_processes(own_folder):
    assert "Mine" not in catalogue()
    motors.use_folder(own_folder)
    assert catalogue()["Mine"].peak_torque("vendor") == 2 * catalogue()["RI70"].peak_torque(
        "vendor"
    )
    design = load_design("hyperleg", overrides={"actuators.knee.motor": "Mine"})
    code = "from hyperleg_design.robot.motors import catalogue; print('Mine' in catalogue())"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "True"
    assert motors.motor_arrays(design).mass.shape == (7,)


def test_a_path_is_a_motor(own_folder):
    path = str(own_folder / "Mine.yaml")
    named = load_design("hyperleg", overrides={"actuators.knee.motor": path})
    peak = motors.motor_arrays(named).peak_torque
    assert peak[3] == motors.load_motor(own_folder / "Mine.yaml").peak_torque("vendor")
    with pytest.raises(InputError, match="no such motor file"):
        load_design("hyperleg", overrides={"actuators.knee.motor": str(own_folder / "No.yaml")})


def test_a_folder_may_be_named_twice_and_is_named_in_commands(own_folder, monkeypatch):
    assert motors.folder_option() == ""
    monkeypatch.chdir(own_folder.parent)
    monkeypatch.setenv(motors.FOLDERS, own_folder.name)  # relative, and again with its full path
    motors.use_folder(own_folder)
    assert "Mine" in catalogue()
    assert motors.folder_option() == f" --motors {own_folder}"


def test_wrong_folders_are_one_clear_error_and_change_nothing(own_folder, tmp_path):
    empty = tmp_path / "empty"
    empty.mkdir()
    double = tmp_path / "double"
    double.mkdir()
    (double / "RI70.yaml").write_text(resources.find("motors", "RI70").read_text())
    for folder, text in (
        (tmp_path / "none", "no folder"),
        (empty, "no motor files"),
        (double, "name of another"),
    ):
        with pytest.raises(InputError, match=text):
            motors.use_folder(folder)
        assert "Mine" not in catalogue()


def test_check_says_that_a_good_file_is_not_reachable(own_folder):
    (finding,) = check_file(own_folder / "Mine.yaml")
    assert finding.severity == "warning"
    assert "--motors" in finding.remedy
    motors.use_folder(own_folder)
    assert check_file(own_folder / "Mine.yaml") == []
    assert check_file(resources.find("motors", "RI70")) == []


def test_constants_are_computed_once_a_design_and_follow_a_file_that_changes(tmp_path, hyperleg):
    path = tmp_path / "MINE.yaml"
    text = (resources.content_folder("motors") / "RI60.yaml").read_text()
    path.write_text(text.replace("RI60", "MINE"))
    design = hyperleg.with_values({"actuators.toe.motor": str(path)})
    first = motor_arrays(design)
    assert motor_arrays(design) is first
    with pytest.raises(ValueError, match="read-only"):
        first.mass[0] = 1.0
    data = yaml.safe_load(path.read_text())
    data["constants"]["mass_g"]["value"] *= 2
    path.write_text(yaml.safe_dump(data))
    assert motor_arrays(design).mass[-1] == 2 * first.mass[-1]
    assert motor_arrays(design).mass[0] == first.mass[0]
