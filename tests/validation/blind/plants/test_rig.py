from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from hyperleg_design.validation.blind.excitation import motion
from hyperleg_design.validation.blind.plants.nuisance import perfect
from hyperleg_design.validation.blind.plants.rig import simulate
from hyperleg_design.validation.blind.plants.rig_build import build_rig
from hyperleg_design.validation.blind.recorder import Recorder, record
from hyperleg_design.validation.blind.residual import residual, rms
from hyperleg_design.validation.blind.robots.catalogue import chain
from hyperleg_design.validation.blind.wrong import Wrong

SILENT = Recorder(
    jitter=0.0, clock=0.0, dropped=0.0, position_noise=0.0, velocity_noise=0.0, torque_noise=0.0
)


def smooth(robot):
    """Without friction."""
    return replace(robot, coulomb=0 * robot.coulomb, viscous=0 * robot.viscous)


def test_energy_is_kept_without_friction_and_drives():
    robot = smooth(chain("leg"))
    plant = build_rig(robot, perfect(robot))
    plant = replace(
        plant,
        stiffness=0 * plant.stiffness,
        damping=0 * plant.damping,
        belt_stiffness=plant.belt_stiffness / 40,
        belt_damping=0 * plant.belt_damping,
    )
    trace = simulate([plant], np.tile(robot.rest, (1, 100, 1)), 200.0, seeds=[0], energy=True)[0]
    assert np.abs(trace.velocity).max() > 1.0  # it swings
    assert np.ptp(trace.energy) < 0.2  # of some 20 J that change places


def test_drives_work_is_where_the_energy_goes():
    robot = smooth(chain("leg"))
    plant = build_rig(robot, perfect(robot))
    plant = replace(
        plant,
        stiffness=0.3 * plant.stiffness,
        damping=0 * plant.damping,
        belt_stiffness=plant.belt_stiffness / 40,
        belt_damping=0 * plant.belt_damping,
    )
    trace = simulate(
        [plant],
        motion("reversals", robot, 1.5, 200.0, np.random.default_rng(0))[None],
        200.0,
        seeds=[0],
        energy=True,
    )[0]
    power = np.sum(trace.drive_torque * trace.motor_velocity, -1)
    work = np.concatenate([[0.0], np.cumsum((power[1:] + power[:-1]) / 2)]) * 1e-3
    gained = trace.energy - trace.energy[0]
    assert np.ptp(gained) > 1.0
    np.testing.assert_allclose(gained, work, atol=0.05 * np.ptp(gained))


@pytest.mark.parametrize("name", ["leg", "arm", "servo"])
def test_stiff_belts_move_as_rigid_bodies_with_rotors(name):
    robot = smooth(chain(name))
    trace = simulate(
        [build_rig(robot, perfect(robot))],
        motion("chirp", robot, 2.0, 200.0, np.random.default_rng(1))[None],
        200.0,
        seeds=[0],
    )[0]
    model = robot.pinocchio()
    data = model.createData()
    window = np.hanning(41)
    window /= window.sum()
    flat = lambda x: np.stack([np.convolve(c, window, "same") for c in x.T], -1)  # noqa: E731
    acceleration = np.gradient(trace.velocity, 1e-3, axis=0)
    needed = np.stack(
        [
            pin.rnea(model, data, q, v, a)
            for q, v, a in zip(trace.position, trace.velocity, acceleration, strict=True)
        ]
    )
    needed += acceleration @ (
        robot.joint_from_motor * robot.rotor_inertia @ robot.joint_from_motor.T
    )
    given = trace.drive_torque @ robot.joint_from_motor.T
    left = flat(given - needed)[200:-200]
    assert np.all(rms(left) < 0.02 * rms(given) + 1e-3)


@pytest.mark.parametrize("name", ["leg", "arm", "servo"])
def test_a_rig_as_its_data_sheet_leaves_nothing_over(name):
    robot = chain(name)
    plain = replace(perfect(robot), coulomb=np.zeros(len(robot.joints)))
    targets = motion("reversals", robot, 3.0, 200.0, np.random.default_rng(2))
    trace = simulate([build_rig(robot, plain)], targets[None], 200.0, seeds=[0])[0]
    log = record(
        trace, targets, robot, SILENT, np.random.default_rng(0), name="x", robot=robot.robot
    )
    left = residual(log, replace(robot, coulomb=0 * robot.coulomb))
    n = len(robot.joints)
    torque = rms(trace.drive_torque @ robot.joint_from_motor.T)
    assert np.all(rms(left)[:n] < 0.03 * torque + 0.01)
    assert np.all(rms(left)[n:] < 0.02 * rms(trace.drive_torque) + 0.002)


def test_friction_slides_at_its_torque():
    robot = chain("servo")
    targets = motion("ramps", robot, 3.0, 200.0, np.random.default_rng(3))
    more = build_rig(robot, perfect(robot), [Wrong("coulomb_friction", "swing", 0.1, {})])
    trace = simulate([more], targets[None], 200.0, seeds=[0])[0]
    data = more.model.createData()
    acceleration = np.gradient(trace.velocity, 1e-3, axis=0)
    bodies = np.stack(
        [
            pin.rnea(more.model, data, q, v, a)
            for q, v, a in zip(trace.position, trace.velocity, acceleration, strict=True)
        ]
    )
    held = (trace.pull - bodies - robot.viscous * trace.velocity)[:, 0]
    sliding = np.abs(trace.velocity[:, 0]) > 0.2
    expected = robot.coulomb[0] + 0.1 * robot.peak_torque[0]
    assert np.median(held[sliding] * np.sign(trace.velocity[sliding, 0])) == pytest.approx(
        expected, rel=0.05
    )


def test_rigs_side_by_side_do_not_see_each_other():
    robot = chain("servo")
    targets = np.stack(
        [motion(k, robot, 0.5, 200.0, np.random.default_rng(4)) for k in ("chirp", "ramps")]
    )
    plants = [
        build_rig(robot, perfect(robot)),
        build_rig(robot, perfect(robot), [Wrong("packet_loss", "robot", 0.2, {})]),
    ]
    both = simulate(plants, targets, 200.0, seeds=[1, 2])
    for i in range(2):
        alone = simulate([plants[i]], targets[i : i + 1], 200.0, seeds=[i + 1])[0]
        np.testing.assert_allclose(alone.position, both[i].position, atol=1e-12)


def test_a_delay_is_a_delay():
    robot = chain("servo")
    targets = motion("chirp", robot, 1.0, 200.0, np.random.default_rng(5))[None]
    trace = simulate(
        [build_rig(robot, perfect(robot), [Wrong("command_delay", "robot", 0.01, {})])],
        targets,
        200.0,
        seeds=[0],
    )[0]
    lags = [
        np.mean((trace.drive_torque[50:-50, 0] - np.roll(trace.command[:, 0], k)[50:-50]) ** 2)
        for k in range(20)
    ]
    assert int(np.argmin(lags)) in (10, 11)
