import dataclasses

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.learning.resolved import task_mapping
from hyperleg_design.resources import sim_names
from hyperleg_design.robot.load import load_robot
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.tasks import load_task, task_from_mapping

PLAIN = {
    "name": "mine",
    "commands": {"kind": "velocity"},
    "observations": {"policy": ["proprioception"], "critic": ["proprioception", "privileged"]},
    "rewards": {"linear_velocity": {"weight": 2.0, "width": 0.2}},
}


def test_shipped_tasks_read():
    assert {"goal", "goal_paper", "walk", "walk_free", "walk_paper"} <= set(sim_names("task"))
    for name in sim_names("task"):
        assert load_task(name).name == name


def test_paper_presets_are_table_ii():
    walk, goal = load_task("walk_paper"), load_task("goal_paper")
    weights = {n: r.weight for n, r in walk.rewards.items()}
    assert weights == {
        "termination": -200,
        "power": -1e-4,
        "thermal": -10,
        "linear_velocity": 2.5,
        "angular_velocity": 0.5,
        "joint_limits": -20,
    }
    assert walk.rewards["linear_velocity"].parameters == {"width": 0.1}
    assert walk.rewards["angular_velocity"].parameters == {"width": 0.2}
    assert goal.rewards["goal_arrival"].weight == 150
    assert goal.rewards["position_progress"].weight == 10
    for task in (walk, goal):
        assert set(task.deviations) == {"joint_limits", "time_step"}
        assert task.control.smoothing == 0.2
        assert task.physics.policy_step == pytest.approx(0.02)
        assert task.physics.time_step == 0.0025
        assert task.limits.duration == 20.0
        assert task.thermal.time_constant == 3.0


@pytest.mark.parametrize("name", sim_names("task"))
def test_every_task_keeps_joints_off_their_stops(name):
    assert load_task(name).rewards["joint_limits"].weight < 0


def test_deviations_are_declared():
    walk = load_task("walk")
    assert {"clock", "contact_match", "foot_slide"} <= set(walk.deviations)
    assert not {"power", "linear_velocity"} & set(walk.deviations)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"rewards": {"powr": 1.0}}, "did you mean power"),
        ({"rewards": {"power": {"weight": 1.0, "width": 2.0}}}, "width"),
        ({"rewards": {"power": {}}}, "weight"),
        ({"rewards": {"goal_arrival": 1.0}}, "kind waypoints"),
        ({"rewards": {"power": "much"}}, "expects a number"),
        ({"observations": {"policy": ["proprioception"]}}, "critic"),
        ({"observations": {"policy": ["smell"], "critic": ["proprioception"]}}, "smell"),
        (
            {"observations": {"policy": ["waypoint"], "critic": ["proprioception"]}},
            "kind waypoints",
        ),
        ({"commands": {"kind": "dance"}}, "one of velocity, waypoints"),
        ({"commands": {"kind": "velocity", "forwrd_low": 1}}, "did you mean forward_low"),
        ({"commands": {"kind": "waypoints", "courses": [[1, 2]]}}, "lists of points|list of lists"),
        ({"control": {"smoothing": 3}}, "within"),
        ({"physics": {"friction_space": "motor"}}, "implicitfast"),
        ({"reward": {}}, "did you mean rewards"),
    ],
)
def test_bad_tasks_are_one_clear_error(change, match):
    with pytest.raises(InputError, match=match) as caught:
        task_from_mapping({**PLAIN, **change}, "mine.yaml")
    assert caught.value.where == "mine.yaml" or change.get("physics")


def test_a_missing_section_or_file_is_named(tmp_path):
    with pytest.raises(InputError, match="commands: is missing"):
        task_from_mapping({k: v for k, v in PLAIN.items() if k != "commands"}, "mine.yaml")
    with pytest.raises(InputError, match="shipped: goal"):
        load_task("stroll")
    with pytest.raises(InputError, match="no such file"):
        load_task(tmp_path / "none.yaml")


def test_a_user_file_is_read(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(
        "name: mine\ncommands: {kind: velocity}\nobservations: {policy: [proprioception], critic: "
        "[privileged]}\nrewards: {power: -1e-4}\n"
    )
    task = load_task(path)
    assert task.rewards["power"].weight == -1e-4
    assert np.isclose(task.commands.test_speed, 1.33)


def test_a_posture_replaces_the_designs(design):
    task = task_from_mapping({**PLAIN, "posture_deg": {"knee": 10, "hip_pitch": -5}}, "mine.yaml")
    posed = task.posed(design)
    assert (posed.joints.knee.default_deg, posed.joints.hip_pitch.default_deg) == (10, -5)
    assert posed.joints.ankle_pitch.default_deg == design.joints.ankle_pitch.default_deg
    assert task_from_mapping(PLAIN, "mine.yaml").posed(design) is design
    again = task_from_mapping(task_mapping(task), "again")
    assert again.posture_deg == task.posture_deg


@pytest.mark.parametrize("posture", [{"knee": "bent"}, {"knee": 500}, {"elbow": 3}, [1]])
def test_a_posture_that_makes_no_sense_is_refused(posture, design):
    with pytest.raises(InputError):
        task_from_mapping({**PLAIN, "posture_deg": posture}, "mine.yaml").posed(design)


@pytest.mark.parametrize(
    ("task", "field"),
    [
        ("walk", r"rewards\.hip_deviation.*lacks joints hip_yaw, hip_roll.*such as walk_any"),
        ("t_test_free", r"start\.stride_share.*lacks joints.*such as t_test_any"),
        ("walk_upright", r"rewards\.human_cycle.*lacks joints hip_pitch, ankle_pitch"),
    ],
)
def test_a_task_that_names_what_a_robot_lacks_is_refused(task, field):
    robot = load_robot("mini_cheetah")
    chosen = dataclasses.replace(load_task(task), posture_deg={})
    with pytest.raises(InputError, match=field):
        Environment(robot, chosen, simulations=1)


def test_starts_in_mid_stride_need_a_humans_joints():
    task = load_task("walk_any")
    task = task.changed(start=dataclasses.replace(task.start, stride_share=0.5))
    with pytest.raises(InputError, match=r"start\.stride_share.*hip_pitch"):
        task.check_robot(layout_of(load_robot("mini_cheetah")), "mini_cheetah")
    task.check_robot(layout_of(load_robot("parallel_ankle")), "parallel_ankle")


@pytest.mark.parametrize("task", ["walk_any", "t_test_any"])
@pytest.mark.parametrize("name", ["hyperleg", "mini_cheetah", "parallel_ankle"])
def test_the_tasks_for_any_robot_fit_every_walker(name, task):
    environment = Environment(load_robot(name), load_task(task), simulations=2, seed=1)
    environment.reset()
    for _ in range(10):
        step = environment.step(np.zeros((2, environment.action_size)))
    assert not step.ending.any()
    assert np.isfinite(step.reward).all()
    fell = environment.chunks[0].limits.height
    assert fell == pytest.approx(0.5 * environment.layout.default_height)
