import numpy as np
import pytest

from hyperleg_design.simulation import human_gait
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.settings import Clock
from hyperleg_design.simulation.state import Goal, State, read_motion
from hyperleg_design.simulation.terms import rewards
from hyperleg_design.simulation.terms.rewards import TERMS, Robot


@pytest.fixture
def robot(design):
    return Robot(layout_of(design), Clock())


@pytest.fixture
def state(robot):
    """Two robots that stand upright, facing along y, moving at 1.2 m/s ahead and 0.1 m/s to their
    left.
    """
    layout, count = robot.layout, 2
    qpos = np.zeros((count, 21))
    qpos[:, 2], qpos[:, 3], qpos[:, 6] = 0.76, np.sqrt(0.5), np.sqrt(0.5)
    qpos[:, 7:] = layout.default
    qvel = np.zeros((count, 20))
    qvel[:, :2] = -0.1, 1.2
    load = np.zeros((4, count, 12))
    load[:, 0] = 314 / 12
    goal = Goal(
        offset=np.array([[2.0, 0.0], [0.0, 3.0]]),
        distance=np.array([2.0, 3.0]),
        heading_error=np.array([0.0, np.pi / 2]),
        following=np.zeros((2, 2)),
        speed_cap=np.array([1.0, 3.0]),
        progress=np.array([0.02, 0.0]),
        arrived=np.array([False, True]),
        to_path=np.array([[0.0, 0.3], [2.0, 0.0]]),
        deviation=np.array([0.3, 2.0]),
        finished=np.zeros(2, bool),
    )
    return State(
        motion=read_motion(qpos, qvel),
        action=np.full((count, 14), 0.5),
        previous_action=np.zeros((count, 14)),
        command=np.array([[1.2, 0.1, 0.0], [1.0, 0.0, 0.4]]),
        motor_torque=np.zeros((4, count, 14)),
        motor_velocity=np.zeros((4, count, 14)),
        pad_load=load,
        foot_load=load.reshape(4, count, 2, 6).sum(-1),
        pad_slip=np.full((count, 12), 0.2),
        power=np.array([100.0, -5.0]),
        thermal_excess=np.array([0.0, 2.0]),
        phase=np.array([0.1, 0.7]),
        terminated=np.array([False, True]),
        goal=goal,
    )


def value(name, state, robot, **parameters):
    return TERMS[name].function(state, robot, **parameters)


def test_table_ii_is_all_there_and_marked():
    assert {n for n, t in TERMS.items() if t.paper} == {
        "termination",
        "power",
        "thermal",
        "linear_velocity",
        "angular_velocity",
        "goal_arrival",
        "position_progress",
    }
    assert all(t.description for t in TERMS.values())


def test_terms_of_table_ii(state, robot):
    np.testing.assert_array_equal(value("termination", state, robot), [0, 1])
    np.testing.assert_array_equal(value("power", state, robot), [100, -5])
    np.testing.assert_array_equal(value("thermal", state, robot), [0, 2])
    np.testing.assert_allclose(
        value("linear_velocity", state, robot), [1.0, np.exp(-(0.2**2 + 0.1**2) / 0.1)]
    )
    np.testing.assert_allclose(
        value("angular_velocity", state, robot), [1.0, np.exp(-(0.4**2) / 0.2)]
    )
    np.testing.assert_array_equal(value("goal_arrival", state, robot), [0, 1])
    np.testing.assert_array_equal(value("position_progress", state, robot), [0.02, 0])


def test_contact_terms(state, robot):
    # phases 0.1 and 0.7: the left foot should stand, then swing; the right one swings? 0.6 and 0.2
    # both stand
    np.testing.assert_array_equal(rewards.stance(state.phase, 0.62), [[True, True], [False, True]])
    np.testing.assert_array_equal(value("contact_match", state, robot), [1.0, 0.5])
    np.testing.assert_array_equal(value("flight", state, robot), [0.0, 1.0])
    np.testing.assert_allclose(value("foot_slide", state, robot), [0.4, 0.0])
    state.foot_load[2, 0, 1] = 2 * robot.layout.weight
    np.testing.assert_allclose(value("ground_force", state, robot), [0.5, 0.0])


def test_posture_terms(state, robot):
    np.testing.assert_allclose(value("tilt", state, robot), 0.0, atol=1e-12)
    np.testing.assert_allclose(value("hip_deviation", state, robot), 0.0)
    np.testing.assert_allclose(value("joint_limits", state, robot), 0.0)
    np.testing.assert_allclose(value("action_rate", state, robot), 14 * 0.25)
    np.testing.assert_allclose(value("roll_pitch_rate", state, robot), 0.0)
    motion = state.motion
    motion.joint_position[0, [0, 8]] += (
        0.1,
        -0.2,
    )  # left yaw and right roll, which also nears its stop at -5 deg
    motion.joint_position[1, 3] = 3.0  # a knee past 150 deg
    motion.angular_velocity[0] = 1.0, 2.0, 3.0
    np.testing.assert_allclose(value("hip_deviation", state, robot), [0.3, 0.0])
    half = np.deg2rad(75)
    assert value("joint_limits", state, robot)[1] == pytest.approx(3.0 - half - 0.95 * half)
    np.testing.assert_allclose(value("roll_pitch_rate", state, robot), [5.0, 0.0])


def test_stance_flexion_counts_bent_legs_by_the_weight_that_they_bear(state, robot):
    layout, motion = robot.layout, state.motion
    knees, ankles = layout.joint_indices("knee"), layout.joint_indices("ankle_pitch")
    motion.joint_position[:, knees] = 0.5, 0.1
    motion.joint_position[:, ankles] = -0.3, -0.9
    state.foot_load[-1, :, 0] = layout.weight / 4
    state.foot_load[-1, :, 1] = 3 * layout.weight, 0.0
    np.testing.assert_allclose(
        value("stance_flexion", state, robot, free=0.2),
        [0.25 * (0.3 + 0.1) + 0.7, 0.25 * (0.3 + 0.1)],
    )
    motion.joint_position[:, ankles] = 0.9  # plantar flexion is free
    motion.joint_position[:, knees] = 0.2
    np.testing.assert_allclose(value("stance_flexion", state, robot, free=0.2), 0.0)


def test_tilt_is_the_sine_squared_of_the_lean(state, robot):
    lean = 0.3
    qpos = np.zeros((1, 21))
    qpos[:, 3], qpos[:, 4] = np.cos(lean / 2), np.sin(lean / 2)
    state.motion = read_motion(qpos, np.zeros((1, 20)))
    np.testing.assert_allclose(value("tilt", state, robot), np.sin(lean) ** 2)


def test_human_cycle_pays_for_the_cycle_at_the_commanded_velocity(state, robot):
    places, phases = human_gait.cycle(robot.layout.joints)
    motion, goal = state.motion, state.goal
    motion.joint_position[:, places] = phases[7, : len(places)] * human_gait.ANGLE
    motion.joint_velocity[:, places] = phases[7, len(places) :] * human_gait.RATE
    # toward the waypoint at its cap: 1.0 m/s ahead, 3.0 m/s to the left
    np.testing.assert_allclose(
        value("human_cycle", state, robot),
        np.exp(-np.array([0.2**2 + 0.1**2, 1.2**2 + 2.9**2]) / 0.25),
    )
    state.goal = None
    np.testing.assert_allclose(
        value("human_cycle", state, robot), [1.0, np.exp(-(0.2**2 + 0.1**2) / 0.25)]
    )
    state.goal = goal
    phase = 7 / human_gait.PHASES
    state.phase = np.array([phase, phase + 0.5])
    stride = value("human_stride", state, robot)
    assert stride[0] == pytest.approx(value("human_cycle", state, robot)[0])
    assert stride[1] < 0.01 * value("human_cycle", state, robot)[1]  # half a stride away
    motion.joint_position[:, places] += human_gait.ANGLE
    distance = human_gait.distance(
        robot.layout.joints, motion.joint_position, motion.joint_velocity
    )
    near, far = (value("human_cycle", state, robot, spread=spread) for spread in (1.0, 2.0))
    np.testing.assert_allclose(np.log(far / near), 0.75 * distance**2)
    motion.joint_position[:, places] += human_gait.ANGLE
    assert np.all(value("human_cycle", state, robot) < 0.5)


def test_goal_terms(state, robot):
    np.testing.assert_allclose(value("goal_speed", state, robot), [1.0, 0.1])
    np.testing.assert_allclose(value("goal_facing", state, robot), [1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(value("goal_turning", state, robot), [1.0, np.exp(-9.0) - 0.6])
    np.testing.assert_allclose(value("path_deviation", state, robot), [0.3, 1.5])


def test_descriptions_are_whole_sentences():
    for term in TERMS.values():
        assert "\n" not in term.description
        assert term.description.endswith(".")
