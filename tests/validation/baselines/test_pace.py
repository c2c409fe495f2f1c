import numpy as np
import pytest

from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.validation.baselines.pace import fit_pace
from hyperleg_design.validation.baselines.population import position_gap


@pytest.mark.slow
def test_pace_gets_better_and_stays_within_bounds(rig):
    pytest.importorskip("cma", reason="needs cma: the extra baselines")
    short = [condition(log.part(slice(0, 300)), rig.signals[0].subject) for log in rig.logs[:1]]
    found = fit_pace(short, rig.drives, generations=12, population=10)
    again = fit_pace(short, rig.drives, generations=12, population=10)
    assert np.array_equal(found.values, again.values)
    assert (found.values >= rig.drives.low).all()
    assert (found.values <= rig.drives.high).all()
    first, last = (
        float(position_gap(short, rig.drives, v)[0]) for v in (found.history[0][1], found.values)
    )
    assert last < first
    assert found.evaluations == 120
