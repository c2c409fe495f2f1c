from types import SimpleNamespace

import numpy as np

from hyperleg_design.gap.signals.control import control_residual

RNG = np.random.default_rng(0)
M = np.array([[6.0, 6.0], [-4.0, 4.0]])
SUBJECT = SimpleNamespace(
    motors=("front", "back"),
    motor_from_joint=np.linalg.inv(M),
    torque_limit=np.full(2, np.inf),
)
SPRING, DAMPER = RNG.normal(size=(2, 500, 2))


def test_commands_as_declared_leave_nothing():
    logged = (SPRING + DAMPER) @ SUBJECT.motor_from_joint.T
    found, others = control_residual(SUBJECT, logged, SPRING, DAMPER)
    np.testing.assert_allclose(found, 0, atol=1e-12)
    assert others == ()


def test_other_gains_leave_their_difference():
    logged = (0.8 * SPRING + 1.3 * DAMPER) @ SUBJECT.motor_from_joint.T
    found, others = control_residual(SUBJECT, logged, SPRING, DAMPER)
    np.testing.assert_allclose(
        found, (-0.2 * SPRING + 0.3 * DAMPER) @ SUBJECT.motor_from_joint.T, atol=1e-12
    )
    assert others == ()


def test_commands_that_a_limit_holds_say_nothing_of_gains():
    limit = np.array([0.25, np.inf])
    subject = SimpleNamespace(**{**vars(SUBJECT), "torque_limit": limit})
    asked = 1.6 * (SPRING + DAMPER) @ SUBJECT.motor_from_joint.T
    held = np.abs(asked[:, 0]) > limit[0]
    assert 0.1 < held.mean() < 0.7
    found, others = control_residual(subject, np.clip(asked, -limit, limit), SPRING, DAMPER)
    assert others == ()
    np.testing.assert_array_equal(np.isnan(found[:, 0]), held)
    np.testing.assert_allclose(found, np.where(np.isnan(found), np.nan, 0.6 / 1.6 * asked))


def test_controllers_that_damp_rotors_are_held_against_the_speeds_of_these():
    of_rotors = DAMPER + 0.3 * RNG.normal(size=DAMPER.shape)
    for damps in (DAMPER, of_rotors):
        logged = (SPRING + damps) @ SUBJECT.motor_from_joint.T
        found, others = control_residual(SUBJECT, logged, SPRING, DAMPER, of_rotors)
        np.testing.assert_allclose(found, 0, atol=1e-12)
        assert others == ()
    unknown = np.full_like(DAMPER, np.nan)
    found, _ = control_residual(
        SUBJECT, (SPRING + DAMPER) @ SUBJECT.motor_from_joint.T, SPRING, DAMPER, unknown
    )
    np.testing.assert_allclose(found, 0, atol=1e-12)


def test_of_controllers_of_another_form_nothing_is_said():
    logged = (SPRING + DAMPER) @ SUBJECT.motor_from_joint.T
    logged[:, 1] += RNG.normal(size=500)
    found, others = control_residual(SUBJECT, logged, SPRING, DAMPER)
    assert others == ("back",)
    assert np.isnan(found[:, 1]).all()
    assert np.isfinite(found[:, 0]).all()


def test_unknown_samples_stay_unknown_and_few_say_nothing():
    logged = (SPRING + DAMPER) @ SUBJECT.motor_from_joint.T
    logged[10, 0] = np.nan
    logged[50:, 1] = np.nan
    found, others = control_residual(SUBJECT, logged, SPRING, DAMPER)
    assert np.flatnonzero(np.isnan(found[:, 0])).tolist() == [10]
    assert np.isnan(found[:, 1]).all()
    assert others == ()
