import numpy as np

from hyperleg_design.gap.playback.replay import replay
from hyperleg_design.gap.playback.windows import whole_log
from hyperleg_design.validation.baselines.population import predicted
from hyperleg_design.validation.baselines.rollout import Rollout


def test_simulators_agree_with_each_other_and_with_the_replay(rig):
    one, nothing = rig.signals[0], np.zeros(rig.drives.count)
    ours = predicted(one, rig.drives, nothing)[0]
    assert np.allclose(ours, replay(one, windows=whole_log(one)).position[0, 0], atol=1e-9)
    theirs = Rollout(one, rig.drives).positions(nothing)
    assert np.sqrt(np.mean((ours - theirs) ** 2)) < 0.15 * np.sqrt(
        np.mean((one.position[whole_log(one).ticks[0]] - ours) ** 2)
    )
