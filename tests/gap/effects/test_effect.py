"""What holds for every effect of the catalogue."""

import numpy as np
import pytest
from pendulum import Wrong, low_passed

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects import EFFECTS, effect
from hyperleg_design.gap.effects.effect import KINDS, NUISANCE_TORQUES
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.signals import RESIDUALS

FIXED = [name for name, one in EFFECTS.items() if one.kind not in ("foot", "sensor")]
EVERYTHING = ("motor_torque", "motor_torque_command", "temperature", "voltage")


@pytest.fixture(params=["measured", "commanded"])
def signals(request, pendulum):
    return pendulum(Wrong(), duration=4.0, sees=EVERYTHING if request.param == "measured" else ())


@pytest.fixture(scope="module")
def biped(biped_runs):
    return load_subject(None, [biped_runs["standing"]])


def test_catalogue_has_the_interface_identifiers():
    assert set(EFFECTS) >= {
        "coulomb_friction",
        "viscous_friction",
        "stribeck_friction",
        "load_dependent_friction",
        "torque_constant",
        "torque_saturation",
        "thermal_derating",
        "voltage_sag",
        "command_delay",
        "actuator_bandwidth",
        "rotor_inertia",
        "transmission_elasticity",
        "backlash",
        "transmission_ratio",
        "encoder_offset",
        "controller_gain",
        "payload",
        "link_mass",
        "link_com",
        "cogging",
        "joint_spring",
        "imu_bias",
        "ground_friction",
        "ground_compliance",
    }
    assert all(name == one.identifier == effect(name).identifier for name, one in EFFECTS.items())


def test_unknown_effects_are_refused_with_a_suggestion():
    with pytest.raises(InputError, match="did you mean backlash"):
        effect("backlsh")


@pytest.mark.parametrize("name", EFFECTS)
def test_parameters_are_plausible(name):
    one = effect(name)
    assert one.kind in KINDS
    assert one.summary
    assert len({p.name for p in one.parameters}) == len(one.parameters)
    for parameter in one.parameters:
        assert parameter.low <= parameter.null <= parameter.high
        assert parameter.typical > 0
        reached = [parameter.null + parameter.typical, parameter.null - parameter.typical]
        assert any(parameter.low <= value <= parameter.high for value in reached)
        assert parameter.source


@pytest.mark.parametrize("name", FIXED)
def test_nulls_leave_no_trace_and_nothing_is_written_to(name, signals):
    one = effect(name)
    arrays = (
        signals.position,
        signals.velocity,
        signals.acceleration,
        signals.believed,
        signals.rigid,
        signals.command,
        signals.target,
    )
    before = [array.copy() for array in arrays]
    for location in one.locations(signals.subject):
        for residual_name, rows in one.trace(signals, location, np.stack([one.nulls] * 2)).items():
            assert residual_name in RESIDUALS
            assert rows.shape[0] == 2
            assert rows.shape[:0:-1] == signals.residual[residual_name].shape[::-1]
            assert np.nanmax(np.abs(rows)) < 1e-12
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(arrays, before, strict=True))


@pytest.mark.parametrize("name", FIXED)
def test_settings_side_by_side_are_as_one_by_one(name, signals):
    one = effect(name)
    location = one.locations(signals.subject)[0]
    values = np.stack([one.example(location, signals.subject, size) for size in (0.5, 1.0, 2.0)])
    together = one.trace(signals, location, values)
    for row, setting in enumerate(values):
        for residual_name, alone in one.trace(signals, location, setting[None]).items():
            np.testing.assert_allclose(
                together[residual_name][row], alone[0], rtol=1e-9, atol=1e-12
            )


@pytest.mark.parametrize("name", FIXED)
def test_linear_says_whether_twice_the_size_is_twice_the_trace(name, pendulum):
    import dataclasses

    one = effect(name)
    signals = pendulum(Wrong(), duration=4.0, sees=("temperature", "voltage"))
    # a limit that binds, so that what is linear without limits only does not pass for linear
    signals = dataclasses.replace(
        signals, subject=dataclasses.replace(signals.subject, torque_limit=np.array([1.0]))
    )
    location = one.locations(signals.subject)[0]
    deviation = one.usual(location, signals.subject)
    if not one.linear:
        # of shapes or limits: some distance from the nulls is not half as good as twice that
        deviation = np.where(
            [p.shape for p in one.parameters],
            deviation,
            1.5 * (one.example(location, signals.subject) - one.nulls),
        )
        deviation = np.clip(deviation, *(one.bounds(location, signals.subject) - one.nulls))
    deviation = deviation * np.linspace(1.0, 0.4, len(deviation))
    single, double = (
        one.trace(signals, location, (one.nulls + share * deviation)[None])["motion"]
        for share in (0.5, 1.0)
    )
    assert np.allclose(double, 2 * single, rtol=1e-6, atol=1e-9) == one.linear


@pytest.mark.parametrize("name", FIXED)
def test_usual_and_starts_lie_inside_the_bounds(name, signals):
    one = effect(name)
    for location in one.locations(signals.subject):
        low, high = one.bounds(location, signals.subject)
        assert np.all(one.usual(location, signals.subject) > 0)
        assert np.all(
            (low >= [p.low for p in one.parameters]) & (high <= [p.high for p in one.parameters])
        )
        steps = one.steps(location, signals.subject)
        assert np.all((steps > 0) & (steps <= one.usual(location, signals.subject)))
        starts = one.starts(signals, location)
        assert starts.ndim == 2
        assert len(starts) >= 1
        assert np.all((starts >= low) & (starts <= high))
        assert np.all(np.any(starts != one.nulls, 1))


@pytest.mark.parametrize("name", FIXED)
def test_unknown_places_are_refused(name, signals):
    with pytest.raises(InputError):
        effect(name).place("left_elbow", signals.subject)


@pytest.mark.parametrize("name", FIXED)
def test_nulls_change_no_simulation(name, pendulum):
    from hyperleg_design.gap.playback.replay import replay
    from hyperleg_design.gap.playback.windows import short_windows

    one = effect(name)
    signals = pendulum(Wrong(), duration=4.0, sees=("temperature", "voltage"))
    location = one.locations(signals.subject)[0]
    windows = short_windows(signals)
    plain, added = replay(
        signals,
        ((), (one.alteration(location, one.nulls, signals.subject),)),
        windows,
        follow="target",
    ).position
    np.testing.assert_allclose(added, plain, atol=1e-9)


def test_low_pass_of_these_tests_has_no_delay():
    time = np.arange(2000) * 0.005
    wave = np.sin(2 * np.pi * time)
    assert np.abs(low_passed(wave, 0.005) - wave)[200:-200].max() < 1e-3


@pytest.mark.parametrize("name", EFFECTS)
def test_nuisance_parameters_lie_at_places_of_the_robot_and_within_what_is_possible(name, biped):
    one, subject = effect(name), biped
    for location, spreads in one.nuisance_spreads(subject, 0.005).items():
        assert location in one.locations(subject)
        assert spreads.shape == (len(one.parameters),)
        assert np.all(spreads >= 0)
        assert np.all(spreads <= np.ptp(one.bounds(location, subject), axis=0))


@pytest.mark.parametrize("name", EFFECTS)
def test_nuisance_parameters_rest_on_torques_that_are_known(name):
    assert effect(name).nuisance_torque in NUISANCE_TORQUES
