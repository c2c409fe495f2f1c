import numpy as np
from pendulum import Wrong, misfit, waves

from hyperleg_design.gap.effects import effect

ELASTICITY = effect("transmission_elasticity")
SOFT = (8.0, 0.3)


def test_trace_is_what_a_belt_leaves_with_encoders_on_either_side(pendulum):
    joint = pendulum(Wrong(compliance=0.005), gains=SOFT)
    assert misfit(joint, ELASTICITY.trace(joint, "swing", np.array([[0.005, 0.05, 0.0]]))) < 0.15
    motor = pendulum(Wrong(compliance=0.01, motor_side=True))
    right, wrong = (ELASTICITY.trace(motor, "swing", np.array([[0.01, 0.05, side]])) for side in (1.0, 0.0))
    assert misfit(motor, right) < 0.2
    assert misfit(motor, wrong) > 1


def test_simulation_with_it_leaves_its_trace(pendulum):
    from altered import altered

    # softer gains: a stiff loop around a belt with its encoder at the joint is not stable
    subject = pendulum(Wrong(), gains=SOFT).subject
    added = ELASTICITY.alteration("swing", np.array([0.01, 0.05, 0.0]), subject)
    signals = altered(subject, (added,), lambda time: [waves(time)])
    assert misfit(signals, ELASTICITY.trace(signals, "swing", np.array([[0.01, 0.05, 0.0]]))) < 0.45


def test_usual_compliance_rings_at_the_usual_frequency(pendulum):
    from hyperleg_design.gap.effects.transmission_elasticity import RESONANCE

    subject = pendulum(Wrong()).subject
    usual = ELASTICITY.usual("swing", subject)[0]
    assert abs(1 / (2 * np.pi * np.sqrt(usual * subject.rotor_inertia[0])) / RESONANCE - 1) < 1e-9


def test_people_read_stiffness_and_resonance(pendulum):
    subject = pendulum(Wrong()).subject
    usual = ELASTICITY.usual("swing", subject)
    found = ELASTICITY.derived("swing", usual, subject)
    assert np.isclose(found["stiffness"][0] * usual[0], 1)
    assert np.isclose(found["resonance"][0], 12.0)


def test_simulation_with_encoders_at_the_rotor_leaves_the_trace_of_these(simulated):
    signals = simulated("transmission_elasticity", [0.01, 0.05, 1.0])
    right, wrong = (ELASTICITY.trace(signals, "swing", np.array([[0.01, 0.05, side]])) for side in (1.0, 0.0))
    assert misfit(signals, right) < 0.2
    assert misfit(signals, wrong) > 1
