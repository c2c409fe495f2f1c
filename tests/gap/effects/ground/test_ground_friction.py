"""Less friction under a foot: the trace against the simulation."""

from __future__ import annotations

import numpy as np
from grounds import late, rms

from hyperleg_design.gap.effects import effect


def test_a_slippery_foot_leaves_what_the_trace_says(standing):
    signals = standing(friction=0.2)
    trace = effect("ground_friction").trace(signals, "left_foot", np.array([[1.0], [0.2]]))[
        "ground"
    ]
    assert np.nanmax(np.abs(trace[0])) < 1e-9
    residual, expected = (
        late(signals, signals.residual["ground"][:, :2]),
        late(signals, trace[1][:, :2]),
    )
    assert rms(residual) > 30.0
    assert rms(residual - expected) < 0.2 * rms(residual)
    assert np.nanmax(np.abs(trace[1][:, 3:])) < 1e-9
