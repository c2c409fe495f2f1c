"""The build for which masses, friction and reductions are declared."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot import masses
from hyperleg_design.robot.laws.friction import joint_friction
from hyperleg_design.robot.names import JOINTS
from hyperleg_design.robot.parameters.reference_sections import Place, ReferenceReductions

MOTORS = ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle", "toe")
REFLECTED = {"friction.law": "reflected", "friction.motor_share": 1.0, "gears.law": "declared"}
"""All friction is that of the motors, which reaches the joints through the reductions."""


@pytest.mark.parametrize("name", MOTORS)
def test_an_actuator_that_stays_where_the_reference_build_has_it_changes_no_mass(hyperleg, name):
    leaves = {"housed_in": "shank", "position_fraction": 0.25}
    places = {
        f"{section}.{name}.{leaf}": value
        for section in ("reference.places", "actuators")
        for leaf, value in leaves.items()
    }
    before, after = masses.mass_table(hyperleg), masses.mass_table(hyperleg.with_values(places))
    for segment in ("pelvis", "thigh", "shank"):
        assert float(getattr(after, segment)) == pytest.approx(float(getattr(before, segment)))
    assert {float(house.change) for house in after.housed} == {0.0}


def test_zero_stands_for_the_designs_own_reduction(hyperleg):
    """A design with another reduction has other friction only where the reference build's is
    stated.
    """
    toe = JOINTS.index("toe")
    other = {f"transmission.{posture}.toe": 40.0 for posture in ("walking", "standing")}
    unstated = {f"reference.transmission.{posture}.toe": 0.0 for posture in ("walking", "standing")}
    table_one = joint_friction(hyperleg)[0][toe]
    assert joint_friction(hyperleg.with_values(REFLECTED | other))[0][toe] > 1.2 * table_one
    own = hyperleg.with_values(REFLECTED | other | unstated)
    assert joint_friction(own)[0][toe] == pytest.approx(table_one)


def test_half_the_reference_reduction_means_twice_the_friction_of_its_motor(hyperleg):
    """Coulomb friction of a motor reaches the joint times the reduction, viscous friction times its
    square.
    """
    toe = JOINTS.index("toe")
    halved = {
        f"reference.transmission.{posture}.toe": hyperleg[f"reference.transmission.{posture}.toe"]
        / 2
        for posture in ("walking", "standing")
    }
    before = joint_friction(hyperleg)
    after = joint_friction(hyperleg.with_values(REFLECTED | halved))
    np.testing.assert_allclose(after[0][toe], 2 * before[0][toe])
    np.testing.assert_allclose(after[1][toe], 4 * before[1][toe])


@pytest.mark.parametrize(
    ("section", "leaves", "words"),
    [
        (Place, {"housed_in": "foot"}, r"place: housed_in = 'foot'.*pelvis, thigh, shank"),
        (
            Place,
            {"housed_in": "thigh", "position_fraction": 1.2},
            r"fraction = 1\.2.* 0 \.\. 1",
        ),
        (ReferenceReductions, {"knee": -1.0}, r"referencereductions: knee = -1"),
        (ReferenceReductions, {"toe": float("nan")}, r"toe"),
    ],
)
def test_what_no_build_has_is_refused(section, leaves, words):
    with pytest.raises(InputError, match=words):
        section(**leaves)
