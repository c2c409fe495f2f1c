import dataclasses

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.felt import SLOWEST_BANDS, answering, felt_share
from hyperleg_design.gap.signals.filtering import filtered_log


@pytest.fixture(scope="module")
def one(robot_files):
    signals = diagnosed.conditioned(robot_files["coupled"], diagnosed.run("healthy", 0))[0]
    return filtered_log(signals)


def test_what_only_the_accelerations_show_is_felt_by_no_drive(one):
    """Needed torque with something added that the drives do not have, in fast bands alone."""
    signals, row = one.signals, 0
    column = one.rows[row].column
    rng = np.random.default_rng(2)
    band, _, _ = one.labels(row)
    fast = band >= SLOWEST_BANDS
    assert fast.any()

    def share(drives, added):
        rigid = signals.rigid + added
        residual = {"motion": drives - rigid}
        told = dataclasses.replace(signals, rigid=rigid, residual=residual)
        return felt_share(dataclasses.replace(one, signals=told), row)

    noise = np.zeros_like(signals.rigid)
    noise[:, column] = 3 * np.nanstd(signals.rigid[:, column]) * rng.normal(size=len(noise))
    assert share(signals.rigid, 0.0) == pytest.approx(1.0)
    assert share(2 * signals.rigid, 0.0) == pytest.approx(1.0)  # torques of too weak a model
    drowned = share(signals.rigid, noise)
    assert drowned[~fast] == pytest.approx(1.0)
    assert drowned[fast].max() < 0.3


def test_a_controller_answers_below_the_frequency_at_which_it_moves_the_joint(one):
    signals, row, inertia = one.signals, 0, 0.4
    subject = signals.subject
    torque = inertia * signals.acceleration
    soft = dataclasses.replace(subject, gains=np.tile([40.0, 3.0], (2, 1)))
    servo = dataclasses.replace(
        signals,
        subject=soft,
        target=signals.position,
        measured=None,
        believed=torque @ np.linalg.inv(subject.joint_from_motor).T,
    )
    share = answering(dataclasses.replace(one, signals=servo), row)
    bands = one.bands[row]
    assert set(share) == {band.index for band in bands}
    turnover = np.sqrt(40.0 / inertia) / (2 * np.pi)  # 1.6 Hz
    for band in bands:
        if band.high < 0.5 * turnover:
            assert share[band.index] > 0.95
        if band.low > 2 * turnover:
            assert share[band.index] < 0.2
    # a mass on this controller, pushed at one frequency: what the controller gives, over the push
    omega = 2 * np.pi * np.linspace(bands[0].low, bands[0].high, 9)
    moved = 1 / (40.0 + 3.0j * omega - inertia * omega**2)
    given = np.real((40.0 + 3.0j * omega) * moved)
    assert share[bands[0].index] == pytest.approx(np.mean(np.clip(given, 0, 1)))
    stiff = dataclasses.replace(soft, gains=np.tile([4e5, 3.0], (2, 1)))
    held = dataclasses.replace(servo, subject=stiff)
    assert min(answering(dataclasses.replace(one, signals=held), row).values()) > 0.95
    assert set(answering(one, row).values()) == {1.0}  # measured
