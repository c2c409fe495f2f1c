import numpy as np
import pytest

from hyperleg_design.gap.effects.strength import joint_strength
from hyperleg_design.gap.experiments import information as info
from hyperleg_design.gap.experiments.rehearsal import rehearsed
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture(scope="module")
def pendulum(robot_files):
    return load_subject(str(robot_files["pendulum"]))


def signals_of(subject, duration=20.0, frequency=0.5, size=0.5):
    time = np.arange(round(200 * duration)) / 200
    position = (size * np.sin(2 * np.pi * frequency * time) * np.minimum(time, 1))[:, None]
    return condition(rehearsed(subject, "sine", time, position, position), subject)


@pytest.fixture(scope="module")
def sine(pendulum):
    return signals_of(pendulum)


EFFECTS = (
    "coulomb_friction",
    "viscous_friction",
    "rotor_inertia",
    "joint_spring",
    "payload",
    "torque_saturation",
)


def test_standard_deviation_of_viscous_friction_is_that_of_a_regression(pendulum, sine):
    blocks = info.blocks_of(pendulum, ["viscous_friction"])
    gram = info.information(sine, blocks)
    found = info.standard_deviations(gram, blocks, ("viscous_friction", "swing"), pendulum)[
        "damping"
    ]
    noise = info.NOISE * joint_strength(pendulum)[0]
    velocity = sine.velocity[sine.valid, 0]
    independent = len(velocity) * sine.step / (2 * info.NOISE_TIME)
    assert found == pytest.approx(noise / np.sqrt(np.mean(velocity**2) * independent), rel=0.02)


def test_information_adds_up_over_time_and_scales_with_noise(pendulum):
    blocks = info.blocks_of(pendulum, EFFECTS)
    short, long = (info.information(signals_of(pendulum, t), blocks) for t in (10.0, 20.0))
    place = ("coulomb_friction", "swing")
    assert info.strength(long, blocks, place) / info.strength(
        short, blocks, place
    ) == pytest.approx(np.sqrt(2), rel=0.05)
    louder = info.information(signals_of(pendulum, 10.0), blocks, noise=2 * info.NOISE)
    assert np.allclose(4 * louder, short)


def test_one_sine_confuses_spring_and_inertia_two_do_not(pendulum):
    blocks = info.blocks_of(pendulum, EFFECTS)
    inertia, spring = ("rotor_inertia", "swing"), ("joint_spring", "swing")
    slow = info.information(signals_of(pendulum, frequency=0.5), blocks)
    fast = info.information(signals_of(pendulum, frequency=2.0, size=0.3), blocks)
    alone = info.distinction(fast, blocks, inertia, [spring])
    both = info.distinction(slow + fast, blocks, inertia, [spring])
    assert alone < 0.2 * info.strength(fast, blocks, inertia)
    assert both > 2 * alone
    assert info.principal_angle(fast, blocks, inertia, spring) < info.principal_angle(
        slow + fast, blocks, inertia, spring
    )


def test_nothing_is_left_of_an_effect_after_itself(pendulum, sine):
    blocks = info.blocks_of(pendulum, EFFECTS)
    gram = info.information(sine, blocks)
    place = ("viscous_friction", "swing")
    assert info.distinction(gram, blocks, place, [place]) < 1e-2 * info.strength(
        gram, blocks, place
    )
    assert info.principal_angle(gram, blocks, place, place) == pytest.approx(0, abs=1e-3)


def test_a_rest_shows_no_friction_of_motion(pendulum):
    blocks = info.blocks_of(pendulum, EFFECTS)
    gram = info.information(signals_of(pendulum, size=0.0), blocks)
    assert info.strength(gram, blocks, ("viscous_friction", "swing")) < 1e-6
    assert (
        info.standard_deviations(gram, blocks, ("viscous_friction", "swing"), pendulum)["damping"]
        == np.inf
    )


def test_saturation_is_linearised_at_its_own_scale(pendulum):
    blocks = info.blocks_of(pendulum, EFFECTS)
    gram = info.information(signals_of(pendulum, frequency=2.0, size=0.6), blocks)
    place = ("torque_saturation", "swing")
    assert info.strength(gram, blocks, place) > 10
    assert max(info.standard_deviations(gram, blocks, place, pendulum).values()) < 1.0


def test_information_is_symmetric_and_no_less_than_zero(pendulum, sine):
    gram = info.information(sine, info.blocks_of(pendulum, EFFECTS))
    assert np.allclose(gram, gram.T)
    assert np.linalg.eigvalsh(gram).min() > -1e-6 * np.linalg.eigvalsh(gram).max()
