import dataclasses

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.samples import SLOWEST_BANDS, felt_share
from hyperleg_design.gap.signals.filtering import filtered_log


@pytest.fixture(scope="module")
def ready(robot_files):
    return diagnosed.evidence(
        robot_files["coupled"],
        *(diagnosed.run("healthy", s, session="a" if s < 2 else "b") for s in range(3)),
    )


def test_folds_deal_stretches_of_all_logs(ready):
    samples = ready.samples
    assert samples.sessions == 2
    for fold in range(samples.folds):
        assert set(samples.log[samples.fold == fold]) == {0, 1, 2}


@pytest.fixture(scope="module")
def healthy(robot_files):
    signals = diagnosed.conditioned(robot_files["coupled"], diagnosed.run("healthy", 0))[0]
    return filtered_log(signals)


def test_what_only_the_accelerations_show_is_felt_by_no_drive(healthy):
    """Needed torque with something added that the drives do not have, in fast bands alone."""
    signals, row = healthy.signals, 0
    column = healthy.rows[row].column
    rng = np.random.default_rng(2)
    band, _, _ = healthy.labels(row)
    fast = band >= SLOWEST_BANDS
    assert fast.any()

    def share(drives, added):
        rigid = signals.rigid + added
        residual = {"motion": drives - rigid}
        told = dataclasses.replace(signals, rigid=rigid, residual=residual)
        return felt_share(dataclasses.replace(healthy, signals=told), row)

    noise = np.zeros_like(signals.rigid)
    noise[:, column] = 3 * np.nanstd(signals.rigid[:, column]) * rng.normal(size=len(noise))
    assert share(signals.rigid, 0.0) == pytest.approx(1.0)
    assert share(2 * signals.rigid, 0.0) == pytest.approx(1.0)  # torques of too weak a model
    drowned = share(signals.rigid, noise)
    assert drowned[~fast] == pytest.approx(1.0)
    assert drowned[fast].max() < 0.3
