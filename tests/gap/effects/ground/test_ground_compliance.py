"""A softer ground under a foot: the trace against the simulation."""

from __future__ import annotations

import numpy as np
from grounds import late, rms

from hyperleg_design.gap.effects import effect


def test_a_soft_foot_leaves_what_the_trace_says(standing):
    signals = standing(compliance=3.0)
    one = effect("ground_compliance")
    trace = one.trace(signals, "left_foot", np.array([[3.0, 1.0], [1.0, 1.0]]))["ground"]
    residual, expected = (
        late(signals, signals.residual["ground"][:, 2]),
        late(signals, trace[0][:, 2]),
    )
    assert rms(residual) > 2 * rms(late(standing(), standing().residual["ground"][:, 2]))
    assert rms(residual - expected) < 0.5 * rms(residual)
    assert np.nanmax(np.abs(trace[1])) < 1e-9
