from __future__ import annotations

import os

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.robot import masses
from hyperleg_design.robot.design import Design, load_design
from hyperleg_design.robot.laws import gear
from hyperleg_design.robot.mass.inertials import inertials
from hyperleg_design.robot.models import leg_reflected_inertia
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.robot.names import JOINTS

KNEE = JOINTS.index("knee")


@pytest.fixture(scope="module")
def design() -> Design:
    return load_design("hyperleg")


@given(
    inertia=st.floats(0, 1e-6),
    mass=st.floats(0, 0.02),
    loss=st.floats(0, 0.05),
    posture=st.sampled_from(["walking", "standing"]),
)
def test_nothing_changes_at_the_papers_reductions(
    inertia: float, mass: float, loss: float, posture: str
) -> None:
    design = load_design(
        overrides={
            "gears.inertia_per_torque": inertia,
            "gears.stage_mass_per_torque": mass,
            "gears.loss_per_doubling": loss,
            "transmission.posture": posture,
        }
    )
    change = gear.gear_change(design)
    assert not np.any(change.rotor_inertia)
    assert not np.any(change.load_torque)
    assert not any(np.any(part) for part in change.stage_mass.values())
    assert masses.mass_table(design).total == pytest.approx(32.0, abs=1e-12)
    np.testing.assert_array_equal(gear.rotor_inertia(design), motor_arrays(design).rotor_inertia)


@given(scale=st.floats(0.5, 2.0))
def test_a_stage_weighs_in_proportion_to_its_peak_torque(scale: float) -> None:
    design = load_design(overrides={"transmission.scale.knee": scale})
    torque = 31.11 * (2.68 + 3 * 1.63)
    expected = design.gears.stage_mass_per_torque * torque * (scale - 1)
    stage = gear.gear_change(design).stage_mass
    assert stage["knee"] == pytest.approx(expected, abs=1e-12)
    assert stage["toe"] == 0
    assert masses.mass_table(design).total == pytest.approx(32.0 + 2 * expected, abs=1e-9)


@given(factor=st.floats(0.6, 1.6))
def test_an_override_of_a_reduction_is_the_same_as_its_scale(factor: float) -> None:
    scaled = load_design(overrides={"transmission.scale.toe": factor})
    stated = load_design(
        overrides={
            f"transmission.{p}.toe": scaled[f"transmission.{p}.toe"] * factor
            for p in ("walking", "standing")
        }
    )
    one, other = gear.gear_change(scaled), gear.gear_change(stated)
    np.testing.assert_allclose(one.load_torque, other.load_torque, atol=1e-12)
    np.testing.assert_allclose(one.stage_mass["toe"], other.stage_mass["toe"], atol=1e-12)


@pytest.mark.parametrize(
    ("leaf", "link"),
    [("knee", "thigh"), ("ankle_roll", "shank"), ("toe", "shank")],
)
def test_a_stages_mass_lands_on_the_link_that_carries_it(leaf: str, link: str) -> None:
    before = inertials(load_design("hyperleg"))
    design = load_design(overrides={f"transmission.scale.{leaf}": 1.5})
    after, change = inertials(design), gear.gear_change(design).stage_mass[leaf]
    assert change > 0
    for name, body in before.items():
        moved = change if name == link else 0.0
        assert after[name].mass == pytest.approx(body.mass + moved, abs=1e-12)
    # The mass sits at the segment's lower end.
    length = design[f"{link}.length"]
    body = before[link]
    com = (body.mass * body.com[2] - change * length) / (body.mass + change)
    assert after[link].com[2] == pytest.approx(com, abs=1e-12)


def test_gear_inertia_follows_similar_gears(design: Design) -> None:
    double = load_design(overrides={"actuators.knee.gear": 14})
    change = gear.gear_change(double).rotor_inertia
    torque = 7 * 2.68
    expected = design.gears.inertia_per_torque * torque ** (5 / 3) * (2 ** (5 / 3) - 1)
    np.testing.assert_allclose(change, np.where(np.arange(7) == KNEE, expected, 0), atol=1e-20)
    total = gear.rotor_inertia(double)[KNEE]
    # The rotor of the knee motor alone: M doubles, so M J M^T of that motor quadruples.
    alone = (2 * 31.11) ** 2 * total + 31.11**2 * gear.rotor_inertia(double)[4:].sum()
    assert leg_reflected_inertia(double)[KNEE, KNEE] == pytest.approx(alone)


def test_catalogue_inertias_lie_on_the_law(design: Design) -> None:
    """Beckhoff AG2250 planetary gears PLE040, 060 and 080: kg cm^2 over Nm."""
    torque, inertia = np.array([24.0, 61.0, 184.0]), np.array([0.014, 0.065, 0.359]) * 1e-4
    law = design.gears.inertia_per_torque * torque ** (5 / 3)
    np.testing.assert_allclose(law, inertia, rtol=0.2)


def test_the_loss_grows_by_the_doubling(design: Design) -> None:
    rated = motor_arrays(design).rated_torque
    for scale, doublings in ((2.0, 1.0), (0.5, -1.0)):
        load = gear.gear_change(
            load_design(overrides={"transmission.scale.knee": scale})
        ).load_torque
        expected = 0.011 * doublings * 31.11 * scale * rated[KNEE:].sum()
        np.testing.assert_allclose(load, np.where(np.arange(7) == KNEE, expected, 0), atol=1e-12)


def test_a_decoupled_motor_has_no_loss() -> None:
    change = gear.gear_change(load_design(overrides={"transmission.scale.toe_ankle_pitch": 0}))
    assert np.all(np.isfinite(change.load_torque))
    assert change.load_torque[JOINTS.index("ankle_pitch")] == 0
    assert change.stage_mass["ankle_pitch"] < 0


def test_a_batch_is_its_designs_one_by_one(design: Design) -> None:
    scales, gears = np.array([0.5, 1.0, 1.7]), np.array([5.0, 7.0, 9.0])
    batch = design.with_values(
        {"transmission.scale.knee": scales, "actuators.toe.gear": gears}, "test"
    )
    whole = gear.gear_change(batch)
    total = masses.mass_table(batch).total
    for index in range(3):
        single = batch.take(index)
        change = gear.gear_change(single)
        np.testing.assert_array_equal(whole.rotor_inertia[index], change.rotor_inertia)
        np.testing.assert_array_equal(whole.load_torque[index], change.load_torque)
        for name, value in change.stage_mass.items():
            assert np.broadcast_to(whole.stage_mass[name], 3)[index] == value
        assert total[index] == masses.mass_table(single).total


def test_the_toes_motor_leaves_its_stages_behind() -> None:
    """Matching the mass of `toe_removed_matched` counts motor, gear and toe, no belts."""
    change = gear.gear_change(load_design("toe_removed"))
    assert not any(np.any(part) for part in change.stage_mass.values())


def test_another_law_is_one_function(design: Design, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gear._LAWS, "by_name", dict(gear._LAWS.by_name))

    @gear.gear_law("feather")
    def feather(_: Design) -> gear.GearChange:
        return gear.GearChange(stage_mass={"knee": -0.1})

    changed = design.with_values({"gears.law": "feather"}, "test")
    assert masses.mass_table(changed).thigh == pytest.approx(5.71 - 0.1)
    with pytest.raises(InputError, match=r"gears\.law"):
        design.with_values({"gears.law": "no such"}, "test")


@pytest.fixture
def calls(monkeypatch):
    """Designs for which the law of gears was called."""
    designs, law = [], gear._LAWS.by_name["catalogue"]

    def counted(design):
        designs.append(design)
        return law(design)

    monkeypatch.setitem(gear._LAWS.by_name, "catalogue", counted)
    return designs


def test_a_change_is_computed_once_for_each_design(calls, monkeypatch):
    robot, same = load_design("hyperleg"), load_design("hyperleg")
    first = gear.gear_change(robot)
    assert gear.gear_change(robot) is first
    assert gear.gear_change(same) is not first
    assert (calls.count(robot), calls.count(same)) == (1, 1)
    monkeypatch.setitem(gear._LAWS.by_name, "catalogue", lambda _: "another law")
    assert gear.gear_change(robot) == "another law"


@pytest.mark.parametrize("leaf", ["actuators.knee.motor", "reference.knee_motor"])
def test_a_motor_whose_file_has_changed_gives_another_change(calls, tmp_path, leaf):
    text = (resources.content_folder("motors") / "RI60.yaml").read_text().replace("RI60", "Mine")
    file = tmp_path / "Mine.yaml"
    file.write_text(text)
    robot = load_design("hyperleg", overrides={leaf: str(file)})
    first = gear.gear_change(robot)
    assert gear.gear_change(robot) is first
    assert calls.count(robot) == 1
    file.write_text(text.replace("description: ", "description: another "))
    os.utime(file, ns=(0, file.stat().st_mtime_ns + 1))
    second = gear.gear_change(robot)
    assert second is not first
    assert gear.gear_change(robot) is second
    assert calls.count(robot) == 2
