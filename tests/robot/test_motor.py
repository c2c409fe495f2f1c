"""One motor: its conventions, and what its file must hold."""

from __future__ import annotations

import numpy as np
import pytest
import yaml

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.robot.motor import RPM, load_motor
from hyperleg_design.robot.motors import catalogue


def edited(change) -> str:
    data = yaml.safe_load((resources.content_folder("motors") / "RI70.yaml").read_text())
    change(data)
    return yaml.safe_dump(data)


@pytest.mark.parametrize("motor", catalogue().values(), ids=catalogue())
def test_every_shipped_constant_names_its_source(motor):
    for group in (motor.constants, *motor.presets.values()):
        for name, constant in group.items():
            assert constant.label != "user", name
            assert len(constant.source) > 5, name


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


def test_a_motor_without_a_name_bears_its_files(write):
    data = yaml.safe_load(resources.find("motors", "RI80").read_text())
    named = load_motor(write("RI80.yaml", yaml.safe_dump(data)))
    del data["name"]
    assert load_motor(write("RI80.yaml", yaml.safe_dump(data))) == named
    assert load_motor(write("Mine.yaml", yaml.safe_dump(data))).name == "Mine"


CHANGES = {
    "half a pole": (
        lambda d: d["constants"]["pole_pairs"].update(value=10.5),
        ["constants.pole_pairs", "10.5", "whole number"],
    ),
    "convention missing": (lambda d: d.pop("convention"), ["convention", "missing"]),
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
        ["constants", "lacks mass_g [g]"],
    ),
    "unknown constant": (
        lambda d: d["constants"].update(mass={"value": 1}),
        ["constants.mass", "mass_g"],
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
        lambda d: d["constants"]["resistance"].update(confidence="sure"),
        ["constants.resistance.confidence", "sure", "high"],
    ),
    "rated": (
        lambda d: d["constants"]["rated_torque"].update(value=5),
        ["constants.rated_torque", "peak_torque"],
    ),
    "presets": (lambda d: d.update(presets=[1]), ["presets", "mapping"]),
    "preset": (lambda d: d["presets"].update(paper=None), ["presets.paper", "mapping"]),
    "preset constant": (
        lambda d: d["presets"]["paper"].pop("power_constant"),
        ["presets.paper", "lacks power_constant [W/Nm^2]"],
    ),
}


@pytest.mark.parametrize("case", CHANGES)
def test_a_motor_file_with_a_fault(write, case):
    change, words = CHANGES[case]
    with pytest.raises(InputError) as caught:
        load_motor(write("RI70.yaml", edited(change)))
    for word in ["RI70.yaml", *words]:
        assert word in str(caught.value)


def test_plain_values_are_the_users_and_give_the_same_motor(write):
    """Designs take plain values, too; their label says that nobody named a source."""

    def plain(data):
        data["constants"] = {k: v["value"] for k, v in data["constants"].items()}
        del data["vendor"], data["product"], data["description"]

    motor, known = load_motor(write("RI70.yaml", edited(plain))), catalogue()["RI70"]
    assert {c.label for c in motor.constants.values()} == {"user"}
    assert {c.confidence for c in motor.constants.values()} == {"low"}
    for name, constant in known.constants.items():
        assert motor.constants[name].value == constant.value
    assert motor.power_constant("vendor") == known.power_constant("vendor")


def test_rpm():
    assert pytest.approx(2 * np.pi) == 60 * RPM
