import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.sizing.inertia import (
    leg_inertia,
    rotor_swing_inertia,
)


@settings(max_examples=15)
@given(data=st.data())
def test_leg_is_pinocchios(random_designs, data):
    import pinocchio as pin

    design = data.draw(random_designs)
    leg = leg_inertia(design)
    body = rigid_body_model(design, floating=False)
    q = np.zeros(body.model.nq)
    matrix = body.mass_matrix(q)
    hip = body.model.getJointId("left_hip_pitch")
    place = body.model.idx_vs[hip]
    assert leg.swing_inertia + rotor_swing_inertia(design) == pytest.approx(
        matrix[place, place], rel=1e-9
    )
    assert leg.swing_inertia == pytest.approx((matrix - body.reflected)[place, place], rel=1e-9)
    # the composite bodies behind joints
    pin.centerOfMass(body.model, body.data, q)
    first, knee = body.model.getJointId("left_hip_yaw"), body.model.getJointId("left_knee")
    masses = [body.data.mass[joint] for joint in (first, hip, knee)]
    np.testing.assert_allclose([leg.leg_mass, leg.swing_mass, leg.distal_mass], masses, rtol=1e-9)
    com = np.array(body.data.com[hip])
    assert leg.com_distance == pytest.approx(np.hypot(com[0], com[2]), rel=1e-9)

    floating = rigid_body_model(design)
    assert leg.total_mass == pytest.approx(pin.computeTotalMass(floating.model), rel=1e-9)


def test_paper_masses():
    leg = leg_inertia(load_design("hyperleg"))
    assert leg.total_mass == pytest.approx(32.0)
    assert leg.leg_mass == pytest.approx(8.27)
    assert leg.distal_mass == pytest.approx(1.68 + 0.66 + 0.22)
    assert leg.leg_length == pytest.approx(0.786)
    assert leg.distal_share == pytest.approx(0.3096, abs=1e-4)
    assert leg.leg_share == pytest.approx(8.27 / 32)


def test_variants_differ_where_their_mass_differs():
    legs = {variant: leg_inertia(load_design("hyperleg", variant=variant)) for variant in VARIANTS}
    for variant in ("toe_locked", "toe_removed_matched"):
        assert legs[variant].swing_inertia == pytest.approx(legs["toe"].swing_inertia)
    gone = legs["toe_removed"]
    assert gone.distal_mass == pytest.approx(legs["toe"].distal_mass - 0.22)
    assert gone.swing_inertia < legs["toe"].swing_inertia
    # the toe's mass as a point on its axis is already most of the difference
    toe = 0.22 * (0.786**2)
    assert legs["toe"].swing_inertia - gone.swing_inertia > 0.8 * toe


def test_point_mass_on_the_toe_adds_its_squared_distance():
    design = load_design("hyperleg").with_values({"toe.mass": np.array([0.2, 0.3])})
    leg = leg_inertia(design)
    com, toe = np.asarray(design.toe.com), design.toe
    x = design.foot.ball_length + com[0]
    z = (
        design.thigh.length
        + design.shank.length
        + design.foot.ankle_height
        - toe.axis_height
        - com[2]
    )
    np.testing.assert_allclose(
        np.diff(leg.swing_inertia), 0.1 * (x**2 + z**2 + toe.gyration[1] ** 2)
    )


def test_batch_equals_each_design():
    values = {
        "toe.mass": np.array([0.1, 0.2, 0.4]),
        "thigh.length": np.array([0.3, 0.35, 0.4]),
        "actuators.knee.motor": np.array(["RI70", "RI60", "U10"]),
        "actuators.hip_pitch.gear": np.array([10.0, 20.0, 30.0]),
    }
    batch = load_design("hyperleg").with_values(values)
    together, rotors = leg_inertia(batch), rotor_swing_inertia(batch)
    for i in range(3):
        alone = leg_inertia(batch.take(i))
        for name, value in vars(alone).items():
            assert getattr(together, name).shape == (3,)
            assert getattr(together, name)[i] == pytest.approx(value, rel=1e-12)
        assert rotors[i] == pytest.approx(rotor_swing_inertia(batch.take(i)))
        assert together.gyration_over_length[i] == pytest.approx(alone.gyration_over_length)


def test_measures_without_dimension_do_not_know_the_scale_of_mass():
    design = load_design("hyperleg")
    names = (
        "pelvis.mass",
        "thigh.mass",
        "shank.mass",
        "foot.mass",
        "foot.cross_mass",
        "toe.mass",
        "hip.yaw_carrier_mass",
        "hip.roll_carrier_mass",
    )
    heavier = leg_inertia(design.with_values({name: 1.5 * design[name] for name in names}))
    leg = leg_inertia(design)
    for name in (
        "leg_share",
        "distal_share",
        "inertia_over_leg",
        "inertia_over_total",
        "gyration_over_length",
    ):
        assert getattr(heavier, name) == pytest.approx(getattr(leg, name))
    assert heavier.swing_inertia == pytest.approx(1.5 * leg.swing_inertia)


def test_a_tree_is_refused_with_what_to_use_instead():
    with pytest.raises(InputError, match=r"mini_cheetah.*family.*link_inertia.*mass_table"):
        leg_inertia(load_robot("mini_cheetah"))
