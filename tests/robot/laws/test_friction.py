from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.design import Design, design_from_mapping, load_design
from hyperleg_design.robot.laws import friction
from hyperleg_design.robot.laws.friction import FRICTION_SPEED, joint_friction
from hyperleg_design.robot.mjcf import mujoco_model
from hyperleg_design.simulation.drives.actuation import actuation_model
from hyperleg_design.simulation.settings import Physics
from hyperleg_design.sizing import demand

COULOMB = (3.30, 3.30, 3.30, 5.59, 2.09, 2.20, 0.88)
VISCOUS = (0.08, 0.08, 0.08, 0.10, 0.10, 0.10, 0.10)
"""Table I."""


@given(share=st.floats(0, 1), posture=st.sampled_from(["walking", "standing"]))
def test_table_i_at_the_papers_design_whatever_the_share(share: float, posture: str) -> None:
    design = load_design(overrides={"friction.motor_share": share, "transmission.posture": posture})
    coulomb, viscous = joint_friction(design)
    np.testing.assert_array_equal(coulomb, COULOMB)
    np.testing.assert_array_equal(viscous, VISCOUS)


@given(share=st.floats(0, 1), scale=st.floats(0.3, 3))
def test_the_motors_share_is_reflected(share: float, scale: float) -> None:
    """With one factor on every reduction of the knee: Coulomb ~ r, viscous ~ r^2."""
    design = load_design(
        overrides={
            "friction.motor_share": share,
            "transmission.scale.knee": scale,
            "gears.loss_per_doubling": 0,
        }
    )
    coulomb, viscous = joint_friction(design)
    expected = np.array(COULOMB), np.array(VISCOUS)
    expected[0][3] *= 1 - share + share * scale
    expected[1][3] *= 1 - share + share * scale**2
    np.testing.assert_allclose(coulomb, expected[0], rtol=1e-12)
    np.testing.assert_allclose(viscous, expected[1], rtol=1e-12)


def test_the_motors_part_goes_through_joint_from_motor() -> None:
    """All friction in the motors and one motor exchanged: each joint by |M| f and M^2 d."""
    values = {"friction.motor_share": 1.0, "actuators.toe.motor": "RI70", "gears.law": "declared"}
    design = load_design(overrides=values)
    matrix = np.abs(transmission.joint_from_motor(design))
    before = np.array([5.04, 5.04, 5.04, 2.68, 1.63, 1.63, 1.63])
    after = np.array([5.04, 5.04, 5.04, 2.68, 1.63, 1.63, 2.68])
    coulomb, viscous = joint_friction(design)
    np.testing.assert_allclose(coulomb, COULOMB * (matrix @ after) / (matrix @ before))
    np.testing.assert_allclose(viscous, VISCOUS * (matrix**2 @ after) / (matrix**2 @ before))


def test_a_motor_that_is_gone_rubs_no_more() -> None:
    values = {"friction.motor_share": 1.0}
    with_motor = joint_friction(load_design("toe_locked", overrides=values))[0]
    without = joint_friction(load_design("toe_removed", overrides=values))[0]
    np.testing.assert_array_equal(with_motor[:6], COULOMB[:6])
    lost = 1.63 / (2.68 + 3 * 1.63)
    assert without[3] == pytest.approx(5.59 * (1 - lost))
    np.testing.assert_array_equal(without[[0, 1, 2, 5]], with_motor[[0, 1, 2, 5]])


def test_a_batch_is_its_designs_one_by_one() -> None:
    design = load_design("hyperleg")
    batch = design.with_values(
        {
            "friction.motor_share": np.array([0.0, 0.5, 1.0]),
            "transmission.scale.ankle_pitch": np.array([0.5, 1.0, 1.7]),
            "actuators.knee.motor": np.array(["RI70", "RI60", "U10"]),
        },
        "test",
    )
    whole = joint_friction(batch)
    for index in range(3):
        for part, single in zip(whole, joint_friction(batch.take(index)), strict=True):
            np.testing.assert_array_equal(part[index], single)


def test_every_room_takes_the_same_friction() -> None:
    design = load_design("toe_removed_matched", overrides={"transmission.scale.knee": 1.3})
    coulomb, viscous = (part[:6] for part in joint_friction(design))
    assert coulomb[3] > 5.59
    model = mujoco_model(design)
    np.testing.assert_allclose(model.dof_frictionloss[6:], [*coulomb, *coulomb])
    np.testing.assert_allclose(model.dof_damping[6:], [*viscous, *viscous])
    simulated = actuation_model(design)
    np.testing.assert_array_equal(simulated.coulomb, coulomb)
    np.testing.assert_array_equal(simulated.viscous, viscous)
    np.testing.assert_allclose(
        demand.joint_friction(design, np.full(6, 5.0)), coulomb + 5 * viscous, rtol=1e-12
    )


def test_sizing_and_simulation_share_the_width() -> None:
    assert Physics().friction_velocity == FRICTION_SPEED
    design = load_design("toe")
    knee = 3
    at_width = demand.joint_friction(design, np.full(7, FRICTION_SPEED))[knee]
    expected = (
        float(design.joints.knee.coulomb) * np.tanh(1.0)
        + float(design.joints.knee.viscous) * FRICTION_SPEED
    )
    np.testing.assert_allclose(at_width, expected)


def test_a_design_without_the_sections_keeps_its_declared_friction() -> None:
    """Designs written before the laws, as policies carry them."""
    data = load_design(overrides={"transmission.scale.knee": 1.4}).to_mapping()
    for section in ("friction", "gears"):
        del data[section]
    del data["reference"]["transmission"]
    coulomb, viscous = joint_friction(design_from_mapping(data, "old"))
    np.testing.assert_array_equal(coulomb, COULOMB)
    np.testing.assert_array_equal(viscous, VISCOUS)


def test_another_law_is_one_function(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(friction._LAWS, "by_name", dict(friction._LAWS.by_name))

    @friction.friction_law("none")
    def none(_: Design) -> tuple[np.ndarray, np.ndarray]:
        return np.zeros(7), np.zeros(7)

    design = load_design(overrides={"friction.law": "none"})
    assert not np.any(joint_friction(design))
    with pytest.raises(InputError, match=r"friction\.law"):
        joint_friction(load_design(overrides={"friction.law": "no such"}))
