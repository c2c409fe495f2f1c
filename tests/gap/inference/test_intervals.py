from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.stats import norm

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.intervals import NORMAL, intervals

SUBJECT = SimpleNamespace(
    joints=("swing",),
    motors=("swing",),
    default=np.zeros(1),
    joint_from_motor=np.eye(1),
    tree=SimpleNamespace(hinge=np.array([True])),
)
SLIDE = SimpleNamespace(**vars(SUBJECT) | {"tree": SimpleNamespace(hinge=np.array([False]))})


def values_of(effect, values, deviation, torque_error=0.0, subject=SUBJECT):
    """Intervals of one cause with given values and standard deviations of its parameters."""
    one = EFFECTS[effect]
    count = len(one.nulls)
    low, high = (np.array([getattr(p, end) for p in one.parameters]) for end in ("low", "high"))
    cause = Cause(
        effect,
        "swing",
        np.array(values),
        one.nulls,
        np.ones(count),
        low,
        high,
        np.zeros(count, bool),
        csr_array((count, 0)),
        np.zeros(0),
        True,
    )
    return intervals(cause, np.array(values), np.array(deviation), subject, torque_error)


def test_a_limit_is_told_with_the_interval_of_its_inverse():
    found = values_of("torque_saturation", [0.5], [0.05])
    inverse, limit = found["inverse_limit"], found["limit"]
    assert (limit.value, limit.unit) == (2.0, "Nm")
    assert limit.low == pytest.approx(1 / inverse.high)
    assert limit.high == pytest.approx(1 / inverse.low)


def test_a_joint_that_slides_has_forces_and_lengths():
    turning = values_of("joint_spring", [2.0, 1.0], [0.1, 0.2])
    sliding = values_of("joint_spring", [2.0, 1.0], [0.1, 0.2], subject=SLIDE)
    assert [one.unit for one in turning.values()] == ["Nm/rad", "Nm", "rad"]
    assert [one.unit for one in sliding.values()] == ["N/m", "N", "m"]
    assert [one.value for one in sliding.values()] == [one.value for one in turning.values()]
    assert values_of("rotor_inertia", [2.0], [0.1], subject=SLIDE)["inertia"].unit == "kg"


def test_a_motor_of_a_slide_has_a_limit_of_force():
    sliding = values_of("torque_saturation", [0.5], [0.05], subject=SLIDE)
    assert [one.unit for one in sliding.values()] == ["1/N", "N"]


def test_a_scale_of_all_torques_widens_forces_too():
    narrow, wide = (
        values_of("coulomb_friction", [3.0, 0], [0.1, 0], error, SLIDE)["torque"]
        for error in (0.0, 0.1)
    )
    assert wide.high - wide.value == pytest.approx(NORMAL * np.hypot(0.1, 0.3))
    assert narrow.high - narrow.value == pytest.approx(NORMAL * 0.1)


def test_what_is_infinite_is_not_told():
    assert "limit" not in values_of("torque_saturation", [0.02], [0.05])


def test_a_rest_angle_has_the_doubt_of_both_numbers_it_comes_of():
    found = values_of("joint_spring", [2.0, 1.0], [0.1, 0.2])["rest"]
    assert found.value == pytest.approx(-0.5)
    assert found.high - found.value == pytest.approx(
        np.hypot(1.96 * 0.2 / 2, 0.5 - 1 / (2 + 1.96 * 0.1)), rel=1e-6
    )


def test_a_rest_angle_that_an_end_of_the_interval_lacks_is_not_stated():
    assert "rest" not in values_of("joint_spring", [1.0, 0.5], [0.48, 0.01])


def test_intervals_end_at_bounds_and_scale_with_the_deviation():
    narrow = values_of("coulomb_friction", [0.3, 0], [0.1, 0])["torque"]
    wide = values_of("coulomb_friction", [0.3, 0], [0.2, 0])["torque"]
    assert wide.high - wide.value == pytest.approx(2 * (narrow.high - narrow.value))
    assert narrow.low >= EFFECTS["coulomb_friction"].parameters[0].low


def test_sizes_of_belts_are_no_better_known_than_their_traces():
    sure = values_of("backlash", [0.02, 1.0, 1.0, 0.0], [1e-5, 0, 0, 0])["angle"]
    assert (sure.low, sure.high) == pytest.approx(
        (0.02 * (1 - 1.96 * 0.15), 0.02 * (1 + 1.96 * 0.15)), rel=1e-3
    )
    doubtful = values_of("backlash", [0.02, 1.0, 1.0, 0.0], [0.004, 0, 0, 0])["angle"]
    assert doubtful.high - 0.02 == pytest.approx(1.96 * np.hypot(0.004, 0.003), rel=1e-6)


def test_an_interval_holds_nineteen_in_twenty():
    assert norm.cdf(NORMAL) - norm.cdf(-NORMAL) == pytest.approx(0.95, abs=1e-4)


def test_sizes_in_units_of_torque_are_no_better_known_than_the_torques():
    friction = values_of("coulomb_friction", [0.3, 0], [0.004, 0], torque_error=0.1)["torque"]
    assert friction.high - 0.3 == pytest.approx(1.96 * np.hypot(0.004, 0.03), rel=1e-6)
    gains = values_of("controller_gain", [0.8, 1.0], [0.004, 0.0], torque_error=0.1)
    assert gains["stiffness_scale"].high - 0.8 == pytest.approx(1.96 * 0.004, rel=1e-6)
