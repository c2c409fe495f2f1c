import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.experiments.experiment import (
    ALONE,
    EXPERIMENTS,
    as_mapping,
    separating,
)

PAIRS = [
    (("torque_constant", "payload"), "known payload"),
    (("coulomb_friction", "backlash"), "preload"),
    (("command_delay", "actuator_bandwidth"), "chirp past 8 Hz"),
    (("transmission_elasticity", "command_delay"), "chirp past 8 Hz"),
    (("viscous_friction", "controller_gain"), None),
    (("rotor_inertia", "link_mass"), "several postures"),
    (("encoder_offset", "link_com"), "several postures"),
    (("controller_gain", "torque_saturation"), "several amplitudes"),
    (("thermal_derating", "torque_constant"), "cold and warm"),
]


@pytest.mark.parametrize(("pair", "name"), PAIRS)
def test_look_alikes_have_an_experiment(pair, name):
    for one, other in (pair, pair[::-1]):
        found = separating([(one, "a"), (other, "a")])
        assert found is not None
        assert found.separates(*pair)
        assert name is None or found.name == name


def test_effects_speak_of_experiments_and_effects_that_there_are():
    names = {experiment.name for experiment in EXPERIMENTS}
    for effect in EFFECTS.values():
        assert set(effect.told_apart) <= names, effect.identifier
        others = set().union(*effect.told_apart.values()) | set(effect.look_alikes)
        assert others <= set(EFFECTS), effect.identifier


def test_one_effect_at_two_places_asks_for_one_joint_at_a_time():
    causes = [("coulomb_friction", "hip"), ("coulomb_friction", "knee")]
    assert separating(causes) is ALONE
    assert as_mapping(ALONE, causes)["separates"] == [
        "coulomb_friction at hip",
        "coulomb_friction at knee",
    ]
    assert separating(causes[:1]) is None
