"""What holds for every effect whose traces are sums of a few known ones."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.spanned import SpannedEffect
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject

SPANNED = [name for name, one in EFFECTS.items() if isinstance(one, SpannedEffect)]


@pytest.fixture(scope="module", params=["arm", "biped"])
def signals(request, robot_files, runs, biped_runs):
    robot, log = (
        (robot_files["arm"], runs["arm"])
        if request.param == "arm"
        else (None, biped_runs["standing"])
    )
    return condition(log, load_subject(robot, [log]))


def test_loads_and_centres_of_mass_are_such():
    assert {"payload", "link_com"} <= set(SPANNED)


@pytest.mark.parametrize("name", SPANNED)
def test_every_trace_is_the_sum_that_it_is_said_to_be(name, signals):
    one = EFFECTS[name]
    for location in one.locations(signals.subject)[::3]:
        values = one.starts(signals, location)
        weights, span = (
            one.in_span(location, signals.subject, values),
            one.span(signals, location),
        )
        for residual_name, trace in one.trace(signals, location, values).items():
            spanned = np.tensordot(weights, span[residual_name], 1)
            np.testing.assert_allclose(
                spanned, trace, rtol=1e-9, atol=1e-9 * np.nanmax(np.abs(trace))
            )


@pytest.mark.parametrize("name", SPANNED)
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_the_nearest_values_lie_inside_the_bounds(name, size, signals):
    one, rng = EFFECTS[name], np.random.default_rng(3)
    for location in one.locations(signals.subject)[::3]:
        low, high = one.bounds(location, signals.subject)
        count = one.in_span(location, signals.subject, one.nulls[None]).shape[1]
        values = one.nearest(location, signals.subject, size * rng.normal(size=count))
        assert values.shape[1] == len(low)
        assert np.all((values >= low) & (values <= high))
