"""Hooks at one place: they find it by name, and their constants are those of the alteration."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects.placed import JointHooks, MotorHooks, Placed
from hyperleg_design.gap.model.machine import machine_of
from hyperleg_design.gap.signals.loading import load_subject


def test_hooks_find_their_place_and_take_over_the_constants():
    subject = load_subject("hyperleg")
    machine = machine_of(subject)
    for kind, names in ((JointHooks, subject.joints), (MotorHooks, subject.motors)):
        for place, name in enumerate(names):
            stiffness = np.arange(3.0)
            one = Placed(name, {"stiffness": stiffness}, live=kind)
            found = kind(one, machine, 3, 1e-3)
            assert one.live is kind
            assert found.place == place
            assert found.stiffness is stiffness
