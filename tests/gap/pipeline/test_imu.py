"""Errors of an IMU on a trunk with an arm that is swung through the air: its sensors, orientation
and torques come from MuJoCo's inverse dynamics of a motion that formulas give.
"""

import re
from functools import cache

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.pipeline.diagnose import diagnose

FLYER = """<mujoco><worldbody><body name="trunk" pos="0 0 1"><freejoint/>
  <geom type="box" size="0.15 0.1 0.05" mass="6" contype="0" conaffinity="0"/>
  <site name="imu" pos="0.05 0.02 0.03"/>
  <body name="upper" pos="0.15 0 0"><joint name="shoulder" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 0 0 -0.25" size="0.02" mass="0.8"
      contype="0" conaffinity="0"/>
    <body name="lower" pos="0 0 -0.25"><joint name="elbow" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0 0 -0.25" size="0.02" mass="0.5"
        contype="0" conaffinity="0"/></body></body></body></worldbody>
  <actuator><motor joint="shoulder" name="shoulder" ctrlrange="-20 20"/>
    <motor joint="elbow" name="elbow" ctrlrange="-20 20"/></actuator>
  <sensor><accelerometer name="felt" site="imu"/><gyro name="spin" site="imu"/></sensor></mujoco>"""
JOINTS = ("shoulder", "elbow")
NOISE = {
    "gyro": 2e-3,
    "accelerometer": 0.03,
    "base_orientation": 2e-4,
    "base_velocity": 3e-3,
    "position": 1e-4,
    "motor_torque": 0.02,
}
STEP = 0.005


@cache
def flown(seed, gyro=(0, 0, 0), felt=(0, 0, 0), leans=(0, 0, 0), turned=(0, 0, 0)):
    """A log of 8 s of an IMU that is off by constants, told a vertical that leans, or turned."""
    rng = np.random.default_rng(seed)
    time = np.arange(0, 8, STEP)[:, None]
    waves = np.sin(rng.uniform(0.8, 2.5, 8) * time + rng.uniform(0, 6, 8))
    rotation = Rotation.from_euler("ZYX", [0.4, 0.2, 0.15] * waves[:, :3])
    place, angle = [0.1, 0.1, 0.05] * waves[:, 3:6], [0.7, 0.9] * waves[:, 6:]
    spin = (rotation[:-1].inv() * rotation[1:]).as_rotvec() / STEP
    spin = np.concatenate([spin[:1], (spin[1:] + spin[:-1]) / 2, spin[-1:]])
    velocity = np.gradient(place, STEP, axis=0, edge_order=2)
    speed = np.concatenate([velocity, spin, np.gradient(angle, STEP, axis=0, edge_order=2)], -1)
    model = mujoco.MjModel.from_xml_string(FLYER)
    data = mujoco.MjData(model)
    told: dict[str, list[np.ndarray]] = {kind: [] for kind in ("felt", "spin", "torque")}
    states = place, rotation.as_quat(scalar_first=True), angle
    change = np.gradient(speed, STEP, axis=0, edge_order=2)
    for *state, data.qvel[:], data.qacc[:] in zip(*states, speed, change, strict=True):
        data.qpos[:] = np.concatenate(state)
        mujoco.mj_inverse(model, data)
        told["torque"].append(data.qfrc_inverse[6:].copy())
        for sensor in ("felt", "spin"):
            told[sensor].append(data.sensor(sensor).data.copy())
    mount, world = Rotation.from_rotvec(turned), Rotation.from_rotvec(leans)
    channels = {
        "gyro": ("xyz", np.array(told["spin"]) @ mount.as_matrix() + gyro),
        "accelerometer": ("xyz", np.array(told["felt"]) @ mount.as_matrix() + felt),
        "base_orientation": ("wxyz", (world * rotation).as_quat(True, scalar_first=True)),
        "base_velocity": ("xyz", world.apply(velocity)),
        "position": (JOINTS, angle),
        "motor_torque": (JOINTS, np.array(told["torque"])),
    }
    signals = {
        f"{kind}/{name}": column + NOISE[kind] * rng.normal(size=len(time))
        for kind, (names, values) in channels.items()
        for name, column in zip(names, values.T, strict=True)
    }
    return Log(f"flown {seed}", time[:, 0], signals, Metadata(base="floating", session=str(seed)))


@pytest.fixture(scope="module")
def flyer(tmp_path_factory):
    path = tmp_path_factory.mktemp("flyer") / "flyer.xml"
    path.write_text(FLYER)
    return path


def told(flyer, log, *references):
    return diagnose(flyer, [log], reference=references, threads=1)


@pytest.mark.slow
def test_a_good_sensor_has_no_error(flyer):
    assert told(flyer, flown(5)).verdict == "none"
    assert told(flyer, flown(5, (0.002, 0, 0), (0.03, 0, 0.03)), flown(1)).verdict == "none"


@pytest.mark.parametrize(
    ("gyro", "felt"), [((0.02, -0.03, 0), (0, 0, 0)), ((0, 0, 0), (0.3, 0, -0.4))]
)
@pytest.mark.parametrize("references", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_a_constant_error_is_named_with_its_size(flyer, gyro, felt, references):
    found = told(flyer, flown(5, gyro, felt), *[flown(1)] * references)
    assert [(c.effect, c.location) for c in found.causes] == [("imu_bias", "imu")]
    assert found.where[0].location == "imu"
    for sensor, errors in (("gyro", gyro), ("accelerometer", felt)):
        for axis, error in zip("xyz", errors, strict=True):
            value = found.causes[0].parameters[f"{sensor}_{axis}"]
            assert value.low <= error <= value.high
    assert found.gap.unit == ("rad/s" if any(gyro) else "m/s^2")


@pytest.mark.parametrize("fault", ["leans", pytest.param("turned", marks=pytest.mark.slow)])
def test_a_vertical_that_leans_and_a_sensor_that_is_turned_are_no_error_of_it(flyer, fault):
    found = told(flyer, flown(5, **{fault: (0.03, -0.05, 0)}))
    assert (found.verdict, found.causes) == ("unknown", ())
    angle = re.search(r"by ([\d.]+) rad", found.residual_shape[0]["says"])
    assert float(angle[1]) == pytest.approx(np.hypot(0.03, 0.05), rel=0.05)


def test_an_error_that_references_have_is_no_change(flyer):
    found = told(flyer, flown(5, (0.02, -0.03, 0)), flown(1, (0.02, -0.03, 0)))
    assert found.verdict == "none"
