"""What a designed experiment tells, and what it cannot separate."""

from __future__ import annotations

from hyperleg_design.gap.experiments.designed_experiment import CLEAR, inseparable
from hyperleg_design.gap.experiments.excite import design_experiment


def test_known_look_alikes_of_a_pendulum_stay_inseparable(made):
    # one joint: a shifted encoder and a shifted centre of mass turn gravity alike
    found = {(p.first[0], p.second[0]) for p in inseparable(made.plan)}
    assert ("encoder_offset", "link_com") in found
    assert ("coulomb_friction", "backlash") not in found


def test_without_torque_less_is_known(made):
    subject = made.plan.subject
    blind = design_experiment(subject, rate=100.0, torque=False)
    delay, constant = ("command_delay", "robot"), ("torque_constant", "swing")
    assert blind.shown(delay) > CLEAR
    pair = next(
        p
        for p in blind.pairs
        if p.first[0] == "viscous_friction" and p.second[0] == "controller_gain"
    )
    assert blind.apart(pair) < made.plan.apart(
        next(p for p in made.plan.pairs if (p.first, p.second) == (pair.first, pair.second))
    )
    assert constant in blind.blocks.places
