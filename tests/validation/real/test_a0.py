"""The double pendulum's model against its makers' equations and torques; its declared faults."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.signal import butter, filtfilt

from hyperleg_design.errors import InputError
from hyperleg_design.validation.real import a0
from hyperleg_design.validation.real.a0_model import (
    JOINTS,
    TIP_MASS,
    read_model,
)
from hyperleg_design.validation.real.cases import data_folder

DATA = data_folder()
needs_data = pytest.mark.skipif(
    not (DATA / a0.FOLDER).is_dir(), reason=f"{DATA / a0.FOLDER} with the real logs is absent"
)


def inverse(model, q, v, a):
    """Torques by MuJoCo's inverse dynamics, without Coulomb friction `(t, 2)`."""
    compiled = mujoco.MjModel.from_xml_string(replace(model, coulomb=(0.0, 0.0)).mjcf())
    data, torque = mujoco.MjData(compiled), np.zeros_like(q)
    for k in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(compiled, data)
        torque[k] = data.qfrc_inverse
    return torque


def test_a_recording_that_is_missing_or_lacks_a_column_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        a0.read_recording(tmp_path, "sys_id/none")
    (tmp_path / "x").mkdir()
    (tmp_path / "x" / "short.csv").write_text("time,pos1,vel1,vel2,tau1,tau2\n0,1,1,1,1,1\n")
    with pytest.raises(InputError, match="pos2"):
        a0.read_recording(tmp_path, "x/short")


def smoothed(log):
    """Position, speed, acceleration and torque of a recording below 15 Hz, and its friction."""
    step = float(np.median(np.diff(log.time)))
    even = np.arange(log.time[0], log.time[-1], step)
    kind = a0.MEASURED if f"{a0.MEASURED}/elbow" in log.signals else a0.COMMAND
    b, a = butter(2, 15 * 2 * step)

    def low(name):
        columns = [np.interp(even, log.time, log.signals[f"{name}/{j}"]) for j in JOINTS]
        return filtfilt(b, a, np.stack(columns, 1), axis=0)

    q, torque = low("position"), low(kind)
    v = np.gradient(q, step, axis=0)
    return q, v, np.gradient(v, step, axis=0), torque


@needs_data
@pytest.mark.parametrize(
    ("name", "shoulder", "elbow"),
    [
        ("sys_id/trajectory_00", 0.35, 0.13),
        ("sys_id/trajectory_03", 0.40, 0.14),
        ("sys_id/trajectory_11", 0.28, 0.15),
        ("sys_id_2/060143", 0.33, 0.20),
        ("swing_up/pendubot_1", 0.70, 0.25),
    ],
)
def test_the_model_explains_the_recorded_torques_up_to_what_it_leaves(name, shoulder, elbow):
    """The residual is what a good, imperfect model leaves, root mean square [Nm]; without its
    friction it is larger.
    """
    model = read_model(DATA / a0.FOLDER / a0.MODEL)
    q, v, a, torque = smoothed(a0.read_recording(DATA / a0.FOLDER, name))
    q, v, a, torque = (x[60:-60:4] for x in (q, v, a, torque))
    bare = torque - inverse(model, q, v, a)
    left = bare - np.array(model.coulomb) * np.arctan(100 * v) / (np.pi / 2)
    size = np.sqrt((left**2).mean(0))
    assert size[0] < shoulder
    assert size[1] < elbow
    assert (size < np.sqrt((bare**2).mean(0))).all()


@needs_data
def test_what_is_declared_wrongly_is_there_and_nothing_else():
    made = {}
    for fault in ("nothing", "torque_high_elbow", "encoder_shoulder", "delay_20ms", "tip_twice"):
        made[fault], _ = a0.material(DATA, a0.FIRST, a0.DAY[:1], "full", fault)
    right = made["nothing"]
    for fault, material in made.items():
        same = material.references[0].signals
        for column, values in right.references[0].signals.items():
            np.testing.assert_array_equal(values, same[column], err_msg=fault)
    for k, log in enumerate(right.logs):
        high = made["torque_high_elbow"].logs[k].signals
        shifted = made["encoder_shoulder"].logs[k].signals
        for column, values in log.signals.items():
            factor = 4 / 3 if column in (f"{a0.COMMAND}/elbow", f"{a0.MEASURED}/elbow") else 1.0
            np.testing.assert_allclose(high[column], factor * values)
            added = a0.ENCODER if column == "position/shoulder" else 0.0
            np.testing.assert_allclose(shifted[column], values + added)
        early = made["delay_20ms"].logs[k]
        command = np.interp(early.time + 0.02, log.time, log.signals[f"{a0.COMMAND}/elbow"])
        np.testing.assert_allclose(early.signals[f"{a0.COMMAND}/elbow"], command)
        count = len(early.time)
        np.testing.assert_array_equal(
            early.signals["position/elbow"], log.signals["position/elbow"][:count]
        )
    twice = made["tip_twice"]
    assert twice.robot == right.robot
    assert twice.logs[0].metadata["payload"]["lower"][0] == TIP_MASS
    assert "payload" not in twice.references[0].metadata


@needs_data
def test_a_model_without_friction_or_tip_is_that_model():
    right = a0.material(DATA, a0.FIRST, (), "full", "nothing")[0].robot
    for fault, joints in (("friction_elbow", ["elbow"]), ("friction_both", list(JOINTS))):
        material, truth = a0.material(DATA, a0.FIRST, (), "full", fault)
        there, wrong = (mujoco.MjModel.from_xml_string(text) for text in (right, material.robot))
        for k, joint in enumerate(JOINTS):
            gone = there.dof_frictionloss[k] - wrong.dof_frictionloss[k]
            assert gone == pytest.approx(there.dof_frictionloss[k] if joint in joints else 0.0)
        told = {f.places[0]: f.parameters["torque"] for f in truth.faults}
        assert told == pytest.approx({j: there.dof_frictionloss[JOINTS.index(j)] for j in joints})
    light, _ = a0.material(DATA, a0.FIRST, a0.DAY[:1], "full", "tip_missing")
    body = mujoco.MjModel.from_xml_string(light.robot).body_mass[-1]
    full = mujoco.MjModel.from_xml_string(right).body_mass[-1]
    assert full - body == pytest.approx(TIP_MASS)
    assert light.references[0].metadata["payload"]["lower"][0] == TIP_MASS
    assert "payload" not in light.logs[0].metadata


@needs_data
def test_the_commands_of_the_swing_ups_hold_the_friction_compensation():
    """The elbow has no other command there, so what is told without the compensation is zero."""
    name = a0.SWING[0]
    log = a0.read_recording(DATA / a0.FOLDER, name)
    torque = a0.compensation(DATA / a0.FOLDER, name)
    np.testing.assert_allclose(log.signals[f"{a0.COMMAND}/elbow"], torque[:, 1], atol=1e-9)
    bare, truth = a0.material(DATA, a0.SWING, (), "command", "compensation_untold")
    np.testing.assert_allclose(bare.logs[0].signals[f"{a0.COMMAND}/elbow"], 0.0, atol=1e-9)
    assert truth.kind == "everywhere"


@needs_data
def test_every_case_can_be_made_with_the_truth_that_its_kind_says():
    for case in a0.a0_cases():
        material, truth = case.build(DATA)
        assert truth.kind == case.kind, case.name
        assert material.logs, case.name
        assert truth.references == bool(material.references), case.name
        assert (case.split == "development") == all(
            f"sys_id/{log.name}" in a0.DEVELOPMENT for log in material.logs
        )
        kept = {column.split("/")[0] for column in material.logs[0].signals}
        assert not kept & set(a0.CHANNELS[case.name.split("-")[3]])


def test_the_folder_of_the_logs_follows_the_environment(monkeypatch):
    monkeypatch.setenv("HYPERLEG_DATA", "/somewhere/else")
    assert data_folder() == Path("/somewhere/else")
