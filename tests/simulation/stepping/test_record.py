from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.simulation.alteration import Alteration
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.stepping.record import signals_of
from hyperleg_design.simulation.tasks import load_task


def recorded(design, alterations=None):
    made = Environment(
        design, load_task("walk"), simulations=3, seed=0, threads=1, alterations=alterations
    )
    made.recording = True
    made.reset()
    rng = np.random.default_rng(0)
    for _ in range(3):
        made.step(rng.normal(size=(3, made.action_size)))
    return made


@pytest.fixture(scope="module")
def environment(design):
    made = recorded(design)
    yield made
    made.close()


def test_joint_torque_is_what_the_transmission_makes_of_the_motors(environment) -> None:
    signals = environment.signals()
    chunk = environment.chunks[0]
    matrix = chunk.drive.model.joint_from_motor
    motors = signals["motor_torque"].reshape(3, -1, 2, matrix.shape[-1])
    expected = np.einsum("jm,ntlm->ntlj", matrix, motors).reshape(3, -1, 14)
    np.testing.assert_allclose(signals["driven_joint_torque"], expected, atol=1e-12)


def test_stops_push_toward_the_middle_of_the_range(environment) -> None:
    chunk = environment.chunks[0]
    chunk.record.stops[:] = 2.0
    signals = environment.signals()
    middle = (chunk.layout.lower + chunk.layout.upper) / 2
    np.testing.assert_array_equal(
        signals["stop_torque"], np.where(signals["joint_position"] < middle, 2.0, -2.0)
    )


def test_what_is_forgotten_is_zero_and_the_rest_stays(environment) -> None:
    record = environment.chunks[0].record
    before = record.states.copy()
    record.forget(np.array([1]))
    assert not record.states[:, 1].any()
    np.testing.assert_array_equal(record.states[:, [0, 2]], before[:, [0, 2]])


def test_alterations_that_change_nothing_record_the_same_torques(design) -> None:
    plain, altered = recorded(design), recorded(design, (Alteration(),))
    mine, theirs = plain.signals(), altered.signals()
    for name in ("driven_joint_torque", "joint_friction", "motor_torque", "joint_position"):
        np.testing.assert_allclose(mine[name], theirs[name], atol=1e-9, err_msg=name)
    np.testing.assert_allclose(theirs["told_joint_position"], theirs["joint_position"], atol=1e-12)
    plain.close()
    altered.close()


@pytest.mark.parametrize("alterations", [None, (Alteration(),)])
def test_samples_of_one_simulation_give_its_signals(design, alterations) -> None:
    made = recorded(design, alterations)
    chunk, whole = made.chunks[0], made.signals()
    assert set(whole) - {"joint_friction"} >= {"base_position", "joint_target", "pad_slip"}
    for row in range(3):
        own = {name: values[:, row] for name, values in chunk.samples().items()}
        signals = signals_of(own, made.layouts[0], chunk.drive.model.joint_from_motor)
        assert set(signals) == set(whole) - {"joint_friction"}
        for name, values in signals.items():
            np.testing.assert_array_equal(values, whole[name][row], err_msg=name)
    made.close()
