import numpy as np

from hyperleg_design.gap.effects.needed import needed
from hyperleg_design.gap.model.friction import friction_torque


def test_the_logged_motion_needs_what_the_balance_says_but_for_friction(leg):
    signals = leg(duration=1.0)
    rubbed = friction_torque(signals.subject, signals.position, signals.velocity, None)
    np.testing.assert_allclose(
        needed(signals, signals.position)["motion"] + rubbed, signals.rigid, atol=1e-9
    )


def test_rotors_are_their_inertia_times_the_acceleration(leg):
    signals = leg(duration=1.0)
    whole, bare = (
        needed(signals, signals.position, rotors=with_them)["motion"] for with_them in (True, False)
    )
    np.testing.assert_allclose(
        whole - bare, signals.acceleration @ signals.subject.armature, atol=1e-9
    )


def test_at_rest_only_gravity_is_left(leg):
    signals = leg(duration=1.0)
    still = np.zeros_like(signals.velocity)
    found = needed(signals, signals.position, still, still)["motion"]
    np.testing.assert_allclose(
        found, needed(signals, signals.position, still, still, rotors=False)["motion"], atol=1e-12
    )
    assert np.abs(found).max() > 0.1
