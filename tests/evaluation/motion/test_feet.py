"""Feet are where Pinocchio has them."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.evaluation.motion.feet import foot_places
from hyperleg_design.sizing.contacts import contact_points


def test_places_are_the_means_of_pinocchios_pads(planned_trial, planned):
    samples = np.array([0, 40, 101])
    found = foot_places(planned_trial, samples)
    for i, sample in enumerate(samples):
        pads = contact_points(planned.motion.model, planned.motion.q[sample])[:, :2]
        for foot in (0, 1):
            assert found[i, foot] == pytest.approx(
                pads[planned_trial.layout.pad_foot == foot].mean(0), abs=1e-9
            )
