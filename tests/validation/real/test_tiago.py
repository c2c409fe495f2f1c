"""Cases on the arm of a TIAGo, with a recording of its form."""

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.validation.real.tiago import (
    CONSTANTS,
    DRAWN,
    FOLDER,
    JOINTS,
    WINDOWS,
    material,
    tiago_cases,
)

RATE = 20.0


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("data")
    (folder / FOLDER).mkdir()
    time = np.arange(0, 70, 1 / RATE)
    position = np.sin(np.outer(time, 0.3 + 0.1 * np.arange(8)))
    velocity = np.gradient(position, time, axis=0)
    effort = np.cos(np.outer(time, 1 + np.arange(8)))
    for kind, values in (("position", position), ("velocity", velocity), ("effort", effort)):
        header = ",".join(["t", *(f"- {joint}_{kind}" for joint in JOINTS)])
        path = folder / FOLDER / f"tiago_{kind}.csv"
        np.savetxt(path, np.c_[time, values], delimiter=",", header=header, comments="")
    return folder


def drawn(data, what, place, size, window=2):
    files, truth = material(data, what=what, place=place, size=size, window=window)
    (log,) = files.logs
    return log, truth, files


def test_each_log_is_tested_beside_the_other_four(data):
    healthy = [drawn(data, "nothing", 0, 0.0, window) for window in range(5)]
    assert all(len(files.references) == 4 for *_, files in healthy)
    spans = [(log.time[0], log.time[-1]) for log, *_ in healthy]
    for (begin, end), low, high in zip(spans, WINDOWS[:-1], WINDOWS[1:], strict=True):
        assert low <= begin <= low + 1 / RATE
        assert high - 1 / RATE <= end + 1e-9 <= high + 2e-9
    assert all(truth.kind == "nothing" for _, truth, _ in healthy)


def test_every_case_has_a_truth_at_a_place_of_the_arm(data):
    cases = tiago_cases()
    assert len(cases) == len(DRAWN) + 5
    for case in cases:
        assert case.needs == FOLDER
        _, truth = case.build(data)
        assert truth.kind == case.kind
        assert all(fault.places[0].startswith("arm_") for fault in truth.faults)


def test_a_motor_that_gives_less_than_declared(data):
    log, truth, files = drawn(data, "torque", 2, 0.8)
    assert log.metadata["torque_constant"]["arm_2_joint"] == pytest.approx(CONSTANTS[2] / 0.8)
    assert files.references[0].metadata["torque_constant"]["arm_2_joint"] == CONSTANTS[2]
    assert truth.faults[0].parameters == {"scale": 0.8}


@pytest.mark.parametrize(
    ("what", "added"),
    [
        ("coulomb", lambda q, v: np.sign(v)),
        ("viscous", lambda q, v: v),
        ("spring", lambda q, v: q - q.mean()),
    ],
)
def test_torques_that_act_in_addition_take_current(data, what, added):
    healthy, *_ = drawn(data, "nothing", 0, 0.0)
    changed, truth, _ = drawn(data, what, 4, 3.0)
    joint, column = "arm_4_joint", "motor_current/arm_4_joint"
    more = (changed.signals[column] - healthy.signals[column]) * abs(CONSTANTS[4])
    q, v = healthy.signals[f"position/{joint}"], healthy.signals[f"velocity/{joint}"]
    moving = np.abs(v) > 0.05
    np.testing.assert_allclose(more[moving], 3.0 * added(q, v)[moving], rtol=1e-3)
    assert list(truth.faults[0].parameters.values()) == [3.0]


def test_currents_count_in_the_direction_of_the_joint(data):
    log, *_ = drawn(data, "nothing", 0, 0.0)
    recorded = np.cos(np.outer(log.time, 1 + np.arange(8)))
    for i in CONSTANTS:
        sign = 1 if i < 3 else -1
        np.testing.assert_allclose(
            log.signals[f"motor_current/{JOINTS[i]}"], sign * recorded[:, i], atol=1e-12
        )
    assert "motor_current/arm_5_joint" not in log.signals


def test_encoders_and_loads_are_declared_wrongly(data):
    healthy, *_ = drawn(data, "nothing", 0, 0.0)
    turned, *_ = drawn(data, "encoder", 3, 0.2)
    more = turned.signals["position/arm_3_joint"] - healthy.signals["position/arm_3_joint"]
    np.testing.assert_allclose(more, 0.2)
    loaded, truth, _ = drawn(data, "load", 7, 1.9)
    assert loaded.metadata["payload"]["arm_7_link"][0] == 1.9
    assert truth.faults[0].parameters == {"mass": -1.9}
    assert "gripper_link" in truth.faults[0].places


def test_a_recording_that_is_not_there_is_an_error(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        material(tmp_path, what="nothing", place=0, size=0.0, window=0)
