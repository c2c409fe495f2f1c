"""An IMU that is mounted at an angle and tells the orientation: its trace against logs that are
turned so.
"""

import numpy as np
import pytest
import robots
from scipy.spatial.transform import Rotation

from hyperleg_design.gap.effects import EFFECTS, WEIGHED
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject

FRAME = WEIGHED["turned_frame"]
TURN = np.array([0.02, -0.03, 0.01])


def turned(log, turn):
    """The log of the same robot whose IMU, with its orientation, is turned by `turn`."""
    signals = dict(log.signals)
    for kind in ("gyro", "accelerometer"):
        own = log.vector(kind) @ turn.as_matrix()
        signals |= {f"{kind}/{axis}": own[:, i] for i, axis in enumerate("xyz")}
    quaternion = log.vector("base_orientation")
    told = (Rotation.from_quat(quaternion, scalar_first=True) * turn).as_quat(scalar_first=True)
    signals |= {f"base_orientation/{axis}": told[:, i] for i, axis in enumerate("wxyz")}
    return log.changed(signals=signals)


def test_answers_do_not_name_it_and_a_fixed_base_has_none(robot_files):
    assert "turned_frame" not in EFFECTS
    assert FRAME.locations(load_subject(robot_files["arm"])) == ()
    assert "turned by 0.05 rad" in FRAME.describe(np.array([0.03, -0.04, 0.0]))


@pytest.mark.parametrize("forces", [True, False])
def test_a_log_that_is_turned_so_shows_its_trace(biped_runs, forces):
    log = biped_runs["standing"]
    log = log if forces else robots.without(log, "contact_force")
    subject = load_subject(None, [log])
    before = condition(log, subject)
    after = condition(turned(log, Rotation.from_rotvec(TURN)), subject)
    traces = before.shown(FRAME.trace(before, "imu", TURN[None]))
    for residual_name in ("motion", "base") if forces else ("motion",):
        change = after.residual[residual_name] - before.residual[residual_name]
        seen = np.isfinite(change) & before.valid[:, None]
        left = (traces[residual_name][0] - change)[seen]
        assert np.std(left) < 0.1 * np.std(change[seen])
        assert np.abs(change[seen]).max() > 1.0
