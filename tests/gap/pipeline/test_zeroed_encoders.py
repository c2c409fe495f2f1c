"""A pendulum whose encoder is set to zero where friction holds it, before every log."""

import mujoco
import numpy as np
import pytest

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.pipeline.diagnose import diagnose

MASS, ARM, FRICTION, STEP = 0.6, 0.2, 0.12, 0.004
PENDULUM = f"""<mujoco><option timestep="{STEP}"/><worldbody><body name="link">
<joint name="swing" axis="0 1 0" damping="0.01" frictionloss="{FRICTION}"/>
<inertial pos="0 0 {-ARM}" mass="{MASS}" diaginertia="0.001 0.001 0.001"/></body></worldbody>
<actuator><motor name="swing" joint="swing"/></actuator></mujoco>"""


def log(name, hangs, seed, shift=0.0):
    """A log whose encoder reads 0 where the link hangs, or `shift` more."""
    model = mujoco.MjModel.from_xml_string(PENDULUM)
    data = mujoco.MjData(model)
    data.qpos[0] = hangs
    rng = np.random.default_rng(seed)
    phases, rows = rng.uniform(0, 2 * np.pi, 3), []
    for tick in range(2500):
        time = tick * STEP
        wave = np.sin(2 * np.pi * np.array([0.4, 0.7, 1.3]) * time + phases)
        data.ctrl[0] = 0.5 * min(time, 1.0) * wave.sum()
        rows.append((data.qpos[0] - hangs + shift, data.qvel[0], data.ctrl[0]))
        mujoco.mj_step(model, data)
    position, velocity, torque = np.array(rows).T
    noise = rng.normal(size=(3, len(position)))
    noise[0, 0] = 0.0
    signals = {
        "position/swing": position + 1e-4 * noise[0],
        "velocity/swing": velocity + 0.01 * noise[1],
        "motor_torque/swing": torque + 0.005 * noise[2],
    }
    time = STEP * np.arange(len(position))
    return Log(name, time, signals, Metadata(session=name, base="fixed"))


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    file = tmp_path_factory.mktemp("zeroed") / "pendulum.xml"
    file.write_text(PENDULUM)
    return file


@pytest.fixture(scope="module")
def references():
    return [log("first", 0.04, 1), log("second", -0.05, 2)]


def test_zeros_that_friction_leaves_uncertain_are_no_fault(robot, references):
    found = diagnose(robot, [log("now", 0.06, 3)], reference=references, threads=1)
    assert found.verdict == "none"
    assert not found.reference_differences


@pytest.mark.slow
def test_an_encoder_that_reads_otherwise_where_its_joint_hangs_is_one(robot, references):
    moved = log("now", 0.0, 3, shift=0.2)
    found = diagnose(robot, [moved], reference=references, threads=1)
    assert [cause.effect for cause in found.causes] == ["encoder_offset"]
    offset = found.causes[0].parameters["offset"]
    assert offset.low <= 0.2 <= offset.high
