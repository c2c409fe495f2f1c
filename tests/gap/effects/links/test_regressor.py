"""Regressors that are kept."""

import numpy as np

from hyperleg_design.gap.effects.links import regressor
from hyperleg_design.gap.signals.loading import load_subject


def test_kept_regressors_are_bounded(robot_files, runs, monkeypatch):
    from hyperleg_design.gap.signals.conditioning import condition

    signals = condition(runs["arm"], load_subject(robot_files["arm"]))
    first = regressor.link_regressor(signals, "flange")
    assert regressor.link_regressor(signals, "flange") is first
    monkeypatch.setattr(regressor, "KEPT", int(2.5 * first.nbytes))
    for link in signals.subject.links:
        regressor.link_regressor(signals, link)
    assert sum(r.nbytes for r in regressor._REGRESSORS[signals].values()) <= 2.5 * first.nbytes
    again = regressor.link_regressor(signals, "flange")
    assert again is not first
    np.testing.assert_array_equal(again, first)
