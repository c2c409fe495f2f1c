import dataclasses

import numpy as np
import pytest
from recorded import log_of_recording

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.rollout import record
from hyperleg_design.gap.checks.check import check_log
from hyperleg_design.gap.logs.log import read_log
from hyperleg_design.gap.logs.recording import log_of_trial, write_logs
from hyperleg_design.gap.model.design_subject import subject_of
from hyperleg_design.gap.playback.overlay import Overlay
from hyperleg_design.gap.results.finding import ERROR
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.models import quaternion_matrix, rigid_body_model
from hyperleg_design.simulation.drives.told import TOLD
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.rollout import rollout
from hyperleg_design.simulation.settings import Limits
from hyperleg_design.simulation.tasks import load_task


def waving(seed=0, size=0.6):
    """A policy that moves all joints smoothly, whatever it sees."""
    rng = np.random.default_rng(seed)
    phase, speed = rng.uniform(0, 6, 14), rng.uniform(0.05, 0.3, 14)
    count = [0]

    def policy(observation):
        count[0] += 1
        return np.broadcast_to(size * np.sin(phase + speed * count[0]), (len(observation), 14))

    return policy


class Lifted(Environment):
    """Robots that start high above the floor and fall freely."""

    def reset(self):
        found = super().reset()
        for chunk in self.chunks:
            chunk.drive.qpos[:, 2] += 5.0
        return found


def environment(kind=Environment):
    return kind(
        load_design(),
        load_task("walk").changed(limits=Limits(height=0.1, tilt=3.0)),
        simulations=2,
        seed=1,
        threads=1,
    )


@pytest.fixture(scope="module")
def falling():
    made = environment(Lifted)
    return log_of_recording(made, rollout(made, waving(size=0.2), 40), 1), made


def columns(log, kind, names):
    return log.stack(kind, names)


def test_flight_obeys_the_equations_of_motion(falling):
    """Pinocchio's inverse dynamics of the logged motion needs the logged torques, and no force on
    the base.
    """
    log, made = falling
    joints, step = made.layout.joints, log.step
    model = rigid_body_model(made.design)
    position, velocity = columns(log, "position", joints), columns(log, "velocity", joints)
    rotation = quaternion_matrix(log.vector("base_orientation")[:, [1, 2, 3, 0]].T).transpose(
        2, 0, 1
    )
    # as the simulation steps them, half a step before its places; robots start without turning
    gyro = np.zeros((len(log.time), 3))
    for row, mean in enumerate(log.vector("gyro")[:-1]):
        gyro[row + 1] = 2 * mean - gyro[row]
    world = log.vector("base_velocity") - step / 2 * (
        np.einsum("tij,tj->ti", rotation, log.vector("accelerometer")) - [0, 0, 9.81]
    )
    friction = made.chunks[0].drive
    legs = (len(log.time), 2, -1)
    speed = log.stack("motor_velocity", made.layout.motors).reshape(legs)
    resisted = np.stack(
        [
            friction.friction(v[None], m[None])[0]
            for v, m in zip(velocity.reshape(legs), speed, strict=True)
        ]
    ).reshape(velocity.shape)
    assert np.all(
        (position > made.layout.lower) & (position < made.layout.upper)
    )  # no joint at a stop
    assert np.nanmax(np.abs(log.stack("contact_force", ["left_foot_z", "right_foot_z"]))) == 0
    for row in range(1, len(log.time) - 1, 7):
        q = np.concatenate(
            [
                log.vector("base_position")[row],
                log.vector("base_orientation")[row, [1, 2, 3, 0]],
                position[row],
            ]
        )
        v = np.concatenate([rotation[row].T @ world[row], gyro[row], velocity[row]])
        turning = (gyro[row + 1] - gyro[row]) / step
        felt = log.vector("accelerometer")[row] - rotation[row].T @ [0, 0, 9.81]
        a = np.concatenate(
            [felt - np.cross(gyro[row], v[:3]), turning, (velocity[row + 1] - velocity[row]) / step]
        )
        needed = model.inverse_dynamics(q, v, a)
        # what is added to the log: friction is implicit: the damping of this row times the velocity
        # of the next
        ratio = np.divide(
            velocity[row + 1], velocity[row], out=np.ones(14), where=np.abs(velocity[row]) > 1e-9
        )
        given = columns(log, "joint_torque", joints)[row] - resisted[row] * ratio
        np.testing.assert_allclose(needed[6:], given, atol=1e-6 * (1 + np.abs(given).max()))
        np.testing.assert_allclose(needed[:6], 0, atol=1e-6 * (1 + np.abs(given).max()))


def test_free_fall_feels_no_gravity_on_the_whole(falling):
    log, made = falling
    drop = log.vector("base_position")[:, 2]
    assert drop[-1] < drop[0] - 1
    assert log.metadata.base == "floating"
    assert log.metadata.robot == made.design.name


def test_motors_do_what_the_controller_asks_within_their_limits(falling):
    log, made = falling
    motors = made.layout.motors
    asked, given = log.stack("motor_torque_command", motors), log.stack("motor_torque", motors)
    same = np.abs(asked - given) < 1e-9 * (1 + np.abs(asked))
    assert same.mean() > 0.9
    assert np.all(np.abs(given[~same]) < np.abs(asked[~same]))
    constants = np.array([log.metadata.torque_constant[m] for m in motors])
    np.testing.assert_allclose(log.stack("motor_current", motors) * constants, given)
    stiffness = np.array([log.metadata.gains[j][0] for j in log.joints])
    damping = np.array([log.metadata.gains[j][1] for j in log.joints])
    wanted = stiffness * (
        log.stack("position_target", log.joints) - log.stack("position", log.joints)
    ) - damping * log.stack("velocity", log.joints)
    free = same.all(1)
    np.testing.assert_allclose(log.stack("joint_torque", log.joints)[free], wanted[free], atol=1e-9)


def test_standing_weight_is_carried_and_the_check_finds_no_error():
    made = environment()
    log = log_of_recording(made, rollout(made, lambda o: np.zeros((len(o), 14)), 60))
    load = log.stack("contact_force", ["left_foot_z", "right_foot_z"]).sum(1)
    assert load[100:].mean() == pytest.approx(made.layout.weight, rel=0.05)
    np.testing.assert_allclose(
        load, log.stack("contact_force", [f"{pad}_z" for pad in made.layout.pads]).sum(1)
    )
    assert np.nanmean(log.signals["accelerometer/z"][100:-1]) == pytest.approx(9.81, rel=0.05)
    check = check_log(log)
    assert [f for f in check.findings if f.severity == ERROR] == []
    assert (
        check.column("position_target/left_knee").constant
        or check.column("position_target/left_knee").held % 4 == 0
    )


def test_trials_become_logs(tmp_path):
    made = environment()
    trials = record(waving(), made, 1.0)
    log = log_of_trial(trials[1], name="one", metadata={"session": "a"})
    again = log_of_recording(environment(), rollout(environment(), waving(), 50), 1)
    rows = min(len(log.time), len(again.time))
    assert set(log.signals) == set(again.signals)
    for column in log.signals:
        np.testing.assert_allclose(
            log.signals[column][: rows - 1],
            again.signals[column][: rows - 1],
            atol=1e-9,
            err_msg=column,
        )
    assert (log.metadata.session, log.metadata.extra["outcome"]) == ("a", trials[1].outcome)
    without = log_of_trial(
        dataclasses.replace(trials[0], joint_target=None, base_angular_velocity=None)
    )
    assert not any(
        c.startswith(("position_target", "motor_torque_command", "gyro")) for c in without.signals
    )
    with pytest.raises(InputError, match="ended at once"):
        log_of_trial(dataclasses.replace(trials[0], joint_position=trials[0].joint_position[:1]))


def test_evaluations_become_files_with_their_robots(tmp_path):
    made = environment()
    trials = record(waving(), made, 0.2)

    class Protocol:
        name = "walk"

    class Evaluated:
        policy, protocol = "small policy.onnx", Protocol()

        def __init__(self, trials):
            self.trials = trials

    other = load_design("hyperleg", overrides=["toe.mass=0.3"])
    paths = write_logs(
        tmp_path / "logs",
        [Evaluated(trials), Evaluated([dataclasses.replace(trials[0], design=other)])],
    )
    assert [p.name for p in paths] == [
        "small_policy_walk_000.parquet",
        "small_policy_walk_001.parquet",
        "small_policy_walk_1_000.parquet",
    ]
    logs = [read_log(p) for p in paths]
    robots = [log.metadata.robot for log in logs]
    assert robots[0] == robots[1] != robots[2]
    for robot, mass in ((robots[0], load_design()["toe.mass"]), (robots[2], 0.3)):
        assert load_design(str(tmp_path / "logs" / robot))["toe.mass"] == mass
    np.testing.assert_array_equal(
        logs[0].signals["position/left_knee"],
        trials[0].joint_position[:, list(made.layout.joints).index("left_knee")],
    )


def test_bad_requests():
    made = environment()
    kept = rollout(made, waving(), 3, keep=["joint_position"])
    with pytest.raises(InputError, match="was not kept"):
        log_of_recording(made, kept)
    with pytest.raises(InputError, match=r"simulation = 5: expects 0 .. 1"):
        log_of_recording(made, rollout(made, waving(), 3), 5)


def test_velocities_of_the_base_are_those_of_its_places(falling):
    """In flight, where nothing jerks: central differences of the logged places, of second order in
    the step.
    """
    log, _ = falling
    place, speed = log.vector("base_position"), log.vector("base_velocity")
    np.testing.assert_allclose(
        (place[2:] - place[:-2])[5:-5] / (2 * log.step), speed[1:-1][5:-5], atol=1e-9
    )


def test_with_an_overlay_a_log_says_what_drives_and_sensors_tell():
    """Weak motor, wrong encoder, biased IMU: the log holds the believed torque, the read angle, the
    read rate and force.
    """
    design = load_design()
    change = {
        ("torque_constant", "left_knee"): {"scale": 0.5},
        ("encoder_offset", "right_knee"): {"offset": 0.05},
        ("imu_bias", "imu"): {"gyro_y": 0.2, "accelerometer_z": 1.0},
    }
    task = load_task("walk").changed(limits=Limits(height=0.1, tilt=3.0))
    made = Lifted(
        design,
        task,
        simulations=1,
        seed=1,
        threads=1,
        alterations=Overlay("hyperleg", change, {}).alterations(design),
    )
    recording = rollout(made, waving(size=0.2), 20)
    log, true = log_of_recording(made, recording), recording.signals
    joints, motors = made.layout.joints, made.layout.motors
    knee, other = motors.index("left_knee"), joints.index("right_knee")
    told = log.stack("motor_torque", motors)
    np.testing.assert_allclose(told[:, knee] * 0.5, true["motor_torque"][0][:, knee], atol=1e-12)
    rest = [i for i in range(len(motors)) if i != knee]
    np.testing.assert_allclose(told[:, rest], true["motor_torque"][0][:, rest], atol=1e-12)
    np.testing.assert_allclose(
        log.stack("motor_current", ["left_knee"])[:, 0] * log.metadata.torque_constant["left_knee"],
        told[:, knee],
    )
    matrix = subject_of(design).joint_from_motor
    np.testing.assert_allclose(log.stack("joint_torque", joints), told @ matrix.T, atol=1e-9)
    shift = log.stack("position", joints) - true["joint_position"][0]
    np.testing.assert_allclose(
        shift,
        np.broadcast_to(np.where(np.arange(len(joints)) == other, 0.05, 0.0), shift.shape),
        atol=1e-12,
    )
    stiffness = np.array([log.metadata.gains[j][0] for j in joints])
    damping = np.array([log.metadata.gains[j][1] for j in joints])
    wanted = stiffness * (
        log.stack("position_target", joints) - log.stack("position", joints)
    ) - damping * log.stack("velocity", joints)
    np.testing.assert_allclose(
        log.stack("motor_torque_command", motors) @ matrix.T, wanted, atol=1e-9
    )
    clean = log_of_recording(
        made,
        dataclasses.replace(
            recording, signals={n: v for n, v in true.items() if not n.startswith(TOLD)}
        ),
    )
    assert not np.array_equal(clean.vector("gyro"), log.vector("gyro"))
    np.testing.assert_allclose(
        log.vector("gyro") - clean.vector("gyro"),
        np.tile([0, 0.2, 0], (len(log.time), 1)),
        atol=1e-12,
    )
    np.testing.assert_allclose(
        (log.vector("accelerometer") - clean.vector("accelerometer"))[:-1],
        np.tile([0, 0, 1.0], (len(log.time) - 1, 1)),
        atol=1e-9,
    )


def test_a_quadruped_writes_logs_with_and_without_an_overlay():
    """Four limbs of three motors each; torques at the joints are those of the motors."""
    design = load_robot("mini_cheetah")
    change = {("torque_constant", "front_left_knee"): {"scale": 0.5}}
    weak = Overlay("mini_cheetah", change, {}).alterations(design)
    for alterations in ((), weak):
        made = Environment(
            design, load_task("walk_any"), simulations=1, seed=1, alterations=alterations
        )
        still = rollout(made, lambda seen: np.zeros((len(seen), 12)), 10)
        log = log_of_recording(made, still, 0)
        joints, motors = made.layout.joints, made.layout.motors
        assert log.metadata.gains == dict.fromkeys(joints, (20.0, 0.5))
        told = log.stack("motor_torque", motors) @ subject_of(design).joint_from_motor.T
        np.testing.assert_allclose(log.stack("joint_torque", joints), told, atol=1e-9)
