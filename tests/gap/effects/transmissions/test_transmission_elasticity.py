import dataclasses

import numpy as np
import pytest
from pendulum import Wrong, misfit, run, waves

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.signals.conditioning import condition

ELASTICITY = effect("transmission_elasticity")
SOFT = (8.0, 0.3)


def test_trace_is_what_a_belt_leaves_with_encoders_on_either_side(pendulum):
    joint = pendulum(Wrong(compliance=0.005), gains=SOFT)
    assert (
        misfit(joint, ELASTICITY.trace(joint, "swing", np.array([[0.005, 0.05, 0.0, 0.0, 0.0]])))
        < 0.15
    )
    motor = pendulum(Wrong(compliance=0.01, motor_side=True))
    right, wrong = (
        ELASTICITY.trace(motor, "swing", np.array([[0.01, 0.05, side, 0.0, 0.0]]))
        for side in (1.0, 0.0)
    )
    assert misfit(motor, right) < 0.04
    assert misfit(motor, wrong) > 1


def test_friction_of_a_rotor_stretches_no_belt(pendulum):
    sees = ("motor_torque", "motor_velocity")
    wrong = Wrong(compliance=0.01, rotor_viscous=0.8)
    healthy = pendulum(Wrong(), gains=SOFT).subject
    rubbing = dataclasses.replace(healthy, viscous=np.array([0.8]))
    signals = condition(run(wrong, gains=SOFT, sees=sees), rubbing)
    before, behind = (
        misfit(
            signals,
            ELASTICITY.trace(signals, "swing", np.array([[0.01, 0.05, 0.0, rubs, 0.0]])),
            "transmission",
        )
        for rubs in (0.0, 1.0)
    )
    assert before < 0.15
    assert behind > 2 * before


def test_a_joint_swings_on_a_soft_belt_whose_rotor_is_logged(pendulum):
    """The rotor on its belt rings at 6.5 Hz, and the joint swings at 4.1 Hz."""
    signals = pendulum(Wrong(compliance=0.03, motor_side=True))
    trace = ELASTICITY.trace(signals, "swing", np.array([[0.03, 0.05, 1.0, 0.0, 0.0]]))
    assert misfit(signals, trace) < 0.12  # 0.26 if it followed its rotor as under a slow load


def test_simulation_with_it_leaves_its_trace(pendulum):
    from altered import altered

    # softer gains: a stiff loop around a belt with its encoder at the joint is not stable
    subject = pendulum(Wrong(), gains=SOFT).subject
    added = ELASTICITY.alteration("swing", np.array([0.01, 0.05, 0.0, 0.0, 0.0]), subject)
    signals = altered(subject, (added,), lambda time: [waves(time)])
    assert (
        misfit(signals, ELASTICITY.trace(signals, "swing", np.array([[0.01, 0.05, 0.0, 0.0, 0.0]])))
        < 0.45
    )


def test_usual_compliance_rings_at_the_usual_frequency(pendulum):
    from hyperleg_design.gap.effects.transmissions.transmission_elasticity import RESONANCE

    subject = pendulum(Wrong()).subject
    usual = ELASTICITY.usual("swing", subject)[0]
    assert abs(1 / (2 * np.pi * np.sqrt(usual * subject.rotor_inertia[0])) / RESONANCE - 1) < 1e-9


def test_people_read_stiffness_and_resonance(pendulum):
    subject = pendulum(Wrong()).subject
    usual = ELASTICITY.usual("swing", subject)
    found = ELASTICITY.derived("swing", usual, subject)
    assert np.isclose(found["stiffness"][0] * usual[0], 1)
    assert np.isclose(found["resonance"][0], 12.0)


@pytest.mark.slow
def test_simulation_with_encoders_at_the_rotor_leaves_the_trace_of_these(simulated):
    signals = simulated("transmission_elasticity", [0.01, 0.05, 1.0, 0.0, 0.0])
    right, wrong = (
        ELASTICITY.trace(signals, "swing", np.array([[0.01, 0.05, side, 0.0, 0.0]]))
        for side in (1.0, 0.0)
    )
    assert misfit(signals, right) < 0.2
    assert misfit(signals, wrong) > 1


@pytest.mark.slow
def test_rotors_show_it_beside_their_joints(pendulum):
    values = np.array([[0.01, 0.05, 0.0, 0.0, 0.0]])
    signals = pendulum(Wrong(compliance=0.01), gains=SOFT, sees=("motor_torque", "motor_velocity"))
    assert misfit(signals, ELASTICITY.trace(signals, "swing", values), "transmission") < 0.1
    from altered import altered

    added = ELASTICITY.alteration("swing", values[0], signals.subject)
    simulated = altered(
        signals.subject,
        (added,),
        lambda time: [waves(time)],
        sees=("motor_torque", "motor_velocity"),
    )
    assert misfit(simulated, ELASTICITY.trace(simulated, "swing", values), "transmission") < 0.1
    # positions told by the rotor agree with it
    rotor = pendulum(
        Wrong(compliance=0.01, motor_side=True), sees=("motor_torque", "motor_velocity")
    )
    assert np.abs(rotor.residual["transmission"]).max() < 0.02 * np.abs(rotor.velocity).max()
    assert not ELASTICITY.trace(rotor, "swing", np.array([[0.01, 0.05, 1.0, 0.0, 0.0]]))[
        "transmission"
    ].any()


def test_what_a_search_leaves_as_it_is(pendulum):
    starts = ELASTICITY.starts(pendulum(Wrong()), "swing")
    joints, rotors = (False, False, False, False, True), (False, False, False, True, True)
    bent = (False, False, True, True, False)
    assert {(*s[[2, 3]], tuple(ELASTICITY.fixed(s).tolist())) for s in starts} == {
        (0, 1, joints),
        (0, 0, joints),
        (1, 0, rotors),
        (1, 0, bent),
        (1, 1, bent),
    }
    assert all(s[2] == 1 for s in starts if s[4])
    subject = pendulum(Wrong()).subject
    found = ELASTICITY.alteration("swing", np.array([0.01, 0.05, 1.0, 1.0, 20.0]), subject)
    assert (found.compliance, found.stiffening, found.side) == (0.01, 20.0, 1.0)
