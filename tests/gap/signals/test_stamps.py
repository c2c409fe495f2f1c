"""Samples off their stamps, on the arm of two links of `test_knocking`: textbook dynamics, motion
in bursts that are known to the end.
"""

from functools import cache

import numpy as np
import pytest
from two_links import GAINS, JOINTS, LOSS, MJCF, RATE, ROTOR, mass_and_bias

from hyperleg_design.gap.inference.detectors import knocking
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.stamps import of_acceleration, off_stamps

OFF = 6e-4


@cache
def bursts(off, seed=0):
    """The shoulder swings fast now and then, the elbow little; positions are those some
    milliseconds off.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(0, 16, 1 / RATE)
    late = time + off * rng.standard_normal(len(time))

    def motion(at):
        burst = np.exp(-((((at % 4) - 2) / 0.35) ** 2))
        return np.column_stack([-1.2 + 0.5 * burst * np.sin(9 * at), 0.5 + 0.1 * np.sin(2 * at)])

    h = 1e-4
    q, v, a = (
        motion(time),
        (motion(time + h) - motion(time - h)) / (2 * h),
        (motion(time + h) - 2 * motion(time) + motion(time - h)) / h**2,
    )
    torque = np.empty_like(q)
    for i in range(len(time)):
        mass, bias = mass_and_bias(q[i], v[i])
        torque[i] = mass @ a[i] + ROTOR * a[i] + bias + LOSS * np.tanh(v[i] / 0.02)
    told = motion(late) + 3e-5 * rng.standard_normal(q.shape)
    signals = {}
    for j, name in enumerate(JOINTS):
        signals[f"position/{name}"] = told[:, j]
        signals[f"position_target/{name}"] = q[:, j]
        signals[f"motor_torque/{name}"] = torque[:, j] + 2e-3 * rng.standard_normal(len(time))
    return Log("bursts", time, signals, Metadata(gains=GAINS))


@pytest.fixture
def conditioned(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(MJCF)

    def one(off):
        log = bursts(off)
        return condition(log, load_subject(path, [log]))

    return one


def test_a_log_tells_how_far_its_samples_are_off_their_stamps(conditioned):
    assert off_stamps(conditioned(OFF)) == pytest.approx(OFF, rel=0.1)
    assert off_stamps(conditioned(0.0)) < 0.1 * OFF


def test_fast_joints_are_shaken_by_it_and_resting_ones_are_not(conditioned):
    signals = conditioned(OFF)
    shaken, speed = of_acceleration(signals)[:, 0], np.abs(signals.velocity[:, 0])
    assert shaken[speed > 2].min() > 10 * np.median(shaken[speed < 0.05])


def test_samples_off_their_stamps_are_no_knocks(conditioned, monkeypatch):
    signals = conditioned(OFF)
    assert knocking.knocking([signals]) is None
    monkeypatch.setattr(knocking, "_shaken", lambda one, when: np.zeros((int(when.sum()), 2)))
    assert knocking.knocking([signals]) is not None, "what they would be taken for"
