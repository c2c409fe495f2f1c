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
    RPM,
    catalogue,
    find_motor,
    gather,
    load_motor,
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
        speeds = np.linspace(0, free, 20_001)
        power = speeds * np.minimum(peak, stall * (1 - speeds / free))
        assert motor.peak_power(constants) == pytest.approx(power.max(), rel=1e-4)
        assert motor.rated_heat(constants) == pytest.approx(cp * motor.rated_torque**2, rel=1e-12)
    assert 0 < motor.peak_duty() <= 1
    assert 0.05 < motor.mass < 3
    for name, constant in motor.constants.items():
        assert constant.source, name


@pytest.mark.parametrize("motor", catalogue().values(), ids=catalogue())
def test_torque_constant_and_speed_agree(motor):
    """Kt of direct current and the no-load speed at nominal voltage are two views of one constant:
    V = Kt omega_0, roughly.
    """
    amplitude = {"dc": 1.0, "phase_peak": 2 / 3**0.5 * 3**0.5 / 2, "phase_rms": 2**-0.5}[
        motor.current_convention
    ]
    ratio = (
        motor.torque_constant * amplitude * motor.no_load_speed("vendor") / motor.nominal_voltage
    )
    assert 0.6 < ratio < 1.7


def test_conventions_of_current_and_resistance(write):
    """One motor told in four ways: the heat at a torque is the same."""
    base = yaml.safe_load((resources.content_folder("motors") / "RI70.yaml").read_text())
    base.pop("presets")
    found = []
    for resistance, current, r, kt in (
        ("line_line", "dc", 0.4, 0.1),
        ("phase", "dc", 0.2, 0.1),
        (
            "line_line",
            "phase_peak",
            0.4,
            0.1 * 3**0.5 / 2,
        ),  # 3/2 R_phase i_peak^2 = R_ll i_dc^2 at i_peak = 2/sqrt(3) i_dc
        ("phase", "phase_rms", 0.2, 0.1 * 1.5**0.5),
    ):
        base["convention"].update(resistance=resistance, current=current)
        base["constants"]["resistance"]["value"], base["constants"]["torque_constant"]["value"] = (
            r,
            kt,
        )
        found.append(load_motor(write("RI70.yaml", yaml.safe_dump(base))).power_constant("vendor"))
    np.testing.assert_allclose(found, 40.0, rtol=1e-12)


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


def edited(change) -> str:
    data = yaml.safe_load((resources.content_folder("motors") / "RI70.yaml").read_text())
    change(data)
    return yaml.safe_dump(data)


CHANGES = {
    "vendor": (lambda d: d.pop("vendor"), ["vendor", "missing"]),
    "kind": (lambda d: d.update(kind="stepper"), ["kind", "stepper", "inrunner"]),
    "name": (lambda d: d.update(name="RI71"), ["name", "RI71", "RI70"]),
    "extra": (lambda d: d.update(colour="red"), ["colour", "no such field"]),
    "constants": (lambda d: d.update(constants=[1]), ["constants", "mapping"]),
    "convention": (lambda d: d.update(convention=3), ["convention", "mapping"]),
    "convention text": (
        lambda d: d["convention"].update(current="rms"),
        ["convention.current", "rms", "phase_rms"],
    ),
    "convention list": (
        lambda d: d["convention"].update(resistance=[]),
        ["convention.resistance", "line_line"],
    ),
    "convention typo": (
        lambda d: d["convention"].update(resistence="phase"),
        ["convention.resistence", "did you mean resistance"],
    ),
    "missing constant": (
        lambda d: d["constants"].pop("mass_g"),
        ["constants.mass_g", "missing", "[g]"],
    ),
    "unknown constant": (
        lambda d: d["constants"].update(mass={"value": 1}),
        ["constants.mass", "mass_g"],
    ),
    "plain value": (
        lambda d: d["constants"].update(mass_g=270),
        ["constants.mass_g", "value, label, source and confidence"],
    ),
    "entry typo": (
        lambda d: d["constants"]["mass_g"].update(sorce="x"),
        ["constants.mass_g.sorce", "source"],
    ),
    "unit": (
        lambda d: d["constants"]["mass_g"].update(value=0.2704),
        ["constants.mass_g", "0.2704", "in g"],
    ),
    "sign": (
        lambda d: d["constants"]["resistance"].update(value=-0.4),
        ["constants.resistance", "-0.4", "ohm"],
    ),
    "text": (
        lambda d: d["constants"]["resistance"].update(value="0.4 ohm"),
        ["constants.resistance", "without a unit"],
    ),
    "vector": (
        lambda d: d["constants"]["resistance"].update(value=[0.4]),
        ["constants.resistance", "a number"],
    ),
    "not finite": (
        lambda d: d["constants"]["resistance"].update(value=float("nan")),
        ["constants.resistance", "finite"],
    ),
    "label": (
        lambda d: d["constants"]["resistance"].update(label="guess"),
        ["constants.resistance.label", "guess", "vendor"],
    ),
    "confidence": (
        lambda d: d["constants"]["resistance"].pop("confidence"),
        ["constants.resistance.confidence", "high"],
    ),
    "rated": (
        lambda d: d["constants"]["rated_torque"].update(value=5),
        ["constants.rated_torque", "peak_torque"],
    ),
    "presets": (lambda d: d.update(presets=[1]), ["presets", "mapping"]),
    "preset": (lambda d: d["presets"].update(paper=None), ["presets.paper", "mapping"]),
    "preset constant": (
        lambda d: d["presets"]["paper"].pop("power_constant"),
        ["presets.paper.power_constant", "missing"],
    ),
}


@pytest.mark.parametrize("case", CHANGES)
def test_a_motor_file_with_a_fault(write, case):
    change, words = CHANGES[case]
    with pytest.raises(InputError) as caught:
        load_motor(write("RI70.yaml", edited(change)))
    for word in ["RI70.yaml", *words]:
        assert word in str(caught.value)


def test_a_broken_catalogue_names_its_file(write, tmp_path, monkeypatch):
    for kind in ("descriptions", "motors"):
        (tmp_path / kind).mkdir()
    write("motors/RI70.yaml", edited(lambda d: d.pop("kind")))
    monkeypatch.setenv("HYPERLEG_HOME", str(tmp_path))
    with pytest.raises(InputError, match=r"motors/RI70\.yaml: kind"):
        catalogue()


def test_rpm():
    assert pytest.approx(2 * np.pi) == 60 * RPM


@pytest.fixture
def own_folder(tmp_path, monkeypatch):
    """A folder with one motor of the user's: RI70 under another name, twice as strong."""
    monkeypatch.delenv(motors.FOLDERS, raising=False)
    source = resources.find("motors", "RI70").read_text()
    folder = tmp_path / "mine"
    folder.mkdir()
    data = yaml.safe_load(source) | {"name": "Mine"}
    data["constants"]["peak_torque"]["value"] *= 2
    data.pop("presets", None)
    (folder / "Mine.yaml").write_text(yaml.safe_dump(data))
    yield folder
    monkeypatch.delenv(motors.FOLDERS, raising=False)


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
