import numpy as np
import pytest

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing.motions.walk import WalkPlan, walk


@pytest.fixture(scope="module")
def stride():
    return walk(load_design(), samples=100)


def test_travels_at_its_speed(stride):
    assert stride.distance / stride.duration == pytest.approx(1.33)
    assert np.mean(stride.v[:, 0]) == pytest.approx(1.33, rel=1e-3)


def test_legs_alternate(stride):
    half = len(stride.time) // 2
    np.testing.assert_allclose(
        np.roll(stride.joint_position[:, 0], half, 0), stride.joint_position[:, 1], atol=1e-6
    )
    loaded = np.stack([stride.contact[:, :6].any(1), stride.contact[:, 6:].any(1)], -1)
    assert loaded.any(1).all()
    both = loaded.all(1).mean()
    assert both == pytest.approx(2 * WalkPlan().double_support / 2, abs=0.03)


def test_trunk_is_upright_and_level(stride):
    np.testing.assert_allclose(
        stride.q[:, 3:7], np.array([0, 0, 0, 1.0]) * np.ones((100, 1)), atol=1e-15
    )
    assert np.ptp(stride.q[:, 2]) < 0.05
    assert np.ptp(stride.q[:, 1]) < 0.08


def test_toe_bends_only_where_there_is_one(stride):
    toe = stride.joint_position[..., 6]
    assert toe.min() < np.deg2rad(-25)
    assert walk(load_design(variant="toe_locked"), samples=41).joint_position.shape == (41, 2, 6)


def test_too_long_a_step_says_so():
    with pytest.raises(InfeasibleError, match=r"hyperleg: "):
        walk(load_design(), WalkPlan(step_time=1.2))


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("speed", 0.0),
        ("speed", -1.0),
        ("step_time", float("nan")),
        ("double_support", 1.0),
        ("heel_rise", -0.1),
        ("pitch_off", 2.0),
    ],
)
def test_bad_plans_name_the_field(field, value):
    with pytest.raises(InputError, match=field):
        WalkPlan(**{field: value})


def test_too_few_samples():
    with pytest.raises(InputError, match="samples"):
        walk(load_design(), samples=4)
