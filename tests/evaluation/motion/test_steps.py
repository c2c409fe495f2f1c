"""Contacts and steps of a recorded trial against the plan it was made of."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.evaluation.motion.steps import (
    foot_contacts,
    impact_measures,
    mean_of,
    measured_steps,
    step_measures,
)
from hyperleg_design.evaluation.protocol import Events, Impact


def test_heel_and_forefoot_are_the_pads_behind_and_before_the_ankle(planned_trial, planned):
    contacts = foot_contacts(
        planned_trial, Events(touchdown_load=0.001, lift_load=0.0005, shortest=0)
    )
    layout = planned_trial.layout
    loaded = planned.allocation.contact_force[..., 2] > 0.001 * layout.weight
    for foot in (0, 1):
        for name, behind in (("heel", True), ("forefoot", False)):
            pads = (layout.pad_foot == foot) & ((layout.pad_position[:, 0] < 0) == behind)
            expected = np.tile(loaded[:, pads].any(-1), 20)
            assert np.mean(getattr(contacts, name)[:, foot] == expected) > 0.98
    assert np.array_equal(contacts.feet, contacts.heel | contacts.forefoot)


def test_every_stride_has_two_steps(planned_trial):
    steps = measured_steps(planned_trial, Events())
    assert np.all(np.diff(steps.foot) != 0)
    assert set(np.diff(steps.touchdown).tolist()) <= {83, 84, 85}
    inner = steps.within(200, 3000)
    assert np.all((inner.touchdown < inner.heel_off) & (inner.heel_off < inner.toe_off))


def test_higher_thresholds_shorten_contacts(planned_trial):
    low, high = (
        measured_steps(planned_trial, Events(touchdown_load=on, lift_load=on / 2))
        for on in (0.02, 0.3)
    )
    shares = [
        step_measures(planned_trial, s.within(200, 3000), (200, 3000), Events())["duty_factor"]
        for s in (low, high)
    ]
    assert shares[0] > shares[1]


def test_filter_and_window_change_the_impact(planned_trial):
    steps = measured_steps(planned_trial, Events()).within(200, 3000)
    short, long = (
        impact_measures(planned_trial, steps, Impact(window=w))["grf_peak"] for w in (0.02, 0.1)
    )
    assert short < long
    plain = impact_measures(planned_trial, steps, Impact(cutoff=0))
    assert plain["grf_peak"] == pytest.approx(plain["grf_raw_peak"])
    assert plain["grf_peak_body_weights"] == pytest.approx(
        plain["grf_peak"] / (32 * 9.81), rel=1e-4
    )


def test_mean_of_nothing_is_nan():
    assert np.isnan(mean_of(np.array([])))
    assert np.isnan(mean_of(np.array([np.nan])))
    assert mean_of(np.array([np.nan, 2.0])) == 2
