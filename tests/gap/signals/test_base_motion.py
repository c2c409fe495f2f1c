import numpy as np
import pytest
import robots

from hyperleg_design.errors import InputError
from hyperleg_design.gap.model.mechanism import quaternion_rotation
from hyperleg_design.gap.signals.base_motion import base_motion
from hyperleg_design.gap.signals.loading import load_subject

INNER = slice(20, -20)


@pytest.fixture(scope="module")
def subject():
    return load_subject("hyperleg")


@pytest.mark.parametrize(
    "lacking",
    [
        (),
        ("gyro",),
        ("accelerometer",),
        ("accelerometer", "base_velocity"),
        ("gyro", "accelerometer"),
        ("base_orientation",),
    ],
)
def test_sensors_stand_in_for_each_other(biped_runs, subject, lacking):
    log = biped_runs["standing"]
    motion, notes = base_motion(robots.without(log, *lacking), subject, log.time)
    assert bool(notes) == bool(lacking)
    np.testing.assert_allclose(motion.angular_velocity[INNER], log.vector("gyro")[INNER], atol=0.05)
    np.testing.assert_allclose(
        motion.specific_force[INNER], log.vector("accelerometer")[INNER], atol=0.5
    )
    # the rotation's vertical; heading is free where nobody measured it
    down = quaternion_rotation(log.vector("base_orientation"))[INNER, 2]
    np.testing.assert_allclose(motion.rotation[INNER, 2], down, atol=0.02)


def test_an_accelerometer_off_the_origin_feels_the_turning(subject):
    """A base that spins about z with the sensor 0.1 m along x: its own origin feels gravity
    alone.
    """
    import dataclasses

    from hyperleg_design.gap.logs.log import Log

    time = np.arange(400) * 0.005
    rate, gain = 2 * np.sin(3 * time), 6 * np.cos(3 * time)
    turned = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    felt = np.stack([-0.1 * rate**2, 0.1 * gain, np.full(400, 9.81)], -1) @ turned
    spin = np.stack([0 * rate, 0 * rate, rate], -1) @ turned
    signals = {f"gyro/{a}": spin[:, i] for i, a in enumerate("xyz")} | {
        f"accelerometer/{a}": felt[:, i] for i, a in enumerate("xyz")
    }
    moved = dataclasses.replace(subject, imu_position=np.array([0.1, 0, 0]), imu_rotation=turned)
    motion, _ = base_motion(Log("spin", time, signals), moved, time)
    np.testing.assert_allclose(
        motion.specific_force[INNER], np.tile([0, 0, 9.81], (360, 1)), atol=0.02
    )
    np.testing.assert_allclose(motion.angular_velocity[INNER, 2], rate[INNER], atol=0.01)


def test_too_little_to_know(biped_runs, subject):
    log = biped_runs["standing"]
    for lacking, said in (
        (("gyro", "base_orientation"), "gyro"),
        (("accelerometer", "base_velocity", "base_position"), "accelerometer"),
    ):
        with pytest.raises(InputError, match=said):
            base_motion(robots.without(log, *lacking), subject, log.time)


def test_no_unit_quaternion(biped_runs, subject):
    log = biped_runs["standing"]
    wrong = log.changed(
        signals={
            c: 3 * v if c.startswith("base_orientation/") else v for c, v in log.signals.items()
        }
    )
    with pytest.raises(InputError, match="no unit quaternion"):
        base_motion(wrong, subject, log.time)
