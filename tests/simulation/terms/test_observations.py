import numpy as np
import pytest

from hyperleg_design.simulation.settings import Start
from hyperleg_design.simulation.terms.observations import (
    PARTS,
    SCAN_OFFSET,
    column_names,
    columns,
    size,
)


def named(environment, observations, group="policy"):
    """Values of an observation by column name, of simulation 0."""
    return dict(
        zip(environment.observation_columns[group], observations[group][0].tolist(), strict=True)
    )


def test_columns_hold_what_they_say(make):
    environment = make(simulations=2, commands={"test_share": 1.0}, start=Start(joint_position=0.1))
    environment.reset()
    rng = np.random.default_rng(0)
    actions = [rng.normal(size=(2, 14)) * 0.3 for _ in range(3)]
    for action in actions:
        step = environment.step(action)
    found, critic = (
        named(environment, step.observations),
        named(environment, step.observations, "critic"),
    )
    chunk = environment.chunks[0]
    qpos, qvel = chunk.drive.qpos[0], chunk.drive.qvel[0]
    for index, joint in enumerate(environment.layout.joints):
        assert found[f"joint_position.{joint}"] == pytest.approx(
            qpos[7 + index] - environment.layout.default[index], abs=1e-6
        )
        assert found[f"joint_velocity.{joint}"] == pytest.approx(qvel[6 + index], abs=1e-5)
        assert found[f"action.{joint}"] == pytest.approx(actions[2][0, index], abs=1e-6)
        assert found[f"previous_action.{joint}"] == pytest.approx(actions[1][0, index], abs=1e-6)
    assert [found[f"angular_velocity.{i}"] for i in range(3)] == pytest.approx(qvel[3:6], abs=1e-5)
    assert [found[f"command.{i}"] for i in range(3)] == pytest.approx([1.33, 0, 0])
    import mujoco

    rotation, local = np.zeros(9), np.zeros(3)
    mujoco.mju_quat2Mat(rotation, qpos[3:7])
    mujoco.mju_mulMatTVec3(local, rotation, qvel[:3])
    assert [critic[f"linear_velocity.{i}"] for i in range(3)] == pytest.approx(local, abs=1e-5)
    mujoco.mju_mulMatTVec3(local, rotation, np.array([0.0, 0.0, -1.0]))
    assert [found[f"gravity.{i}"] for i in range(3)] == pytest.approx(local, abs=1e-6)
    assert critic["pelvis_height"] == pytest.approx(qpos[2])
    loads = (
        chunk.sensors[-1, 0].reshape(12, 6)[:, 0].reshape(2, 6).sum(1) / environment.layout.weight
    )
    assert [critic[f"foot_load.{i}"] for i in range(2)] == pytest.approx(loads, abs=1e-5)
    assert found["clock_sine"] ** 2 + found["clock_cosine"] ** 2 == pytest.approx(1)


def test_the_clock_advances_by_its_period(make):
    environment = make(simulations=1)
    first = named(environment, environment.reset())
    for _ in range(25):
        step = environment.step(np.zeros((1, 14)))
    later = named(environment, step.observations)
    assert later["clock_sine"] == pytest.approx(
        -first["clock_sine"], abs=1e-5
    )  # half of a second, half a stride


def test_waypoint_columns(make):
    environment = make(
        "goal",
        simulations=1,
        commands={"course_share": 1.0},
        start=Start(joint_position=0, tilt=0, yaw=1.0),
    )
    found = named(environment, environment.reset())
    assert found["waypoint_distance"] == pytest.approx(9.14)
    assert found["speed_cap"] == pytest.approx(1.4)
    assert [found[f"command.{i}"] for i in range(3)] == pytest.approx([3.0, 0.0, 0.0], abs=1e-6)
    direction = np.array([9.14, 4.57]) / np.hypot(9.14, 4.57) * 3
    assert [found[f"following_waypoint.{i}"] for i in range(2)] == pytest.approx(
        direction, abs=1e-5
    )


def test_height_scan_is_flat(make):
    environment = make("walk_paper", simulations=1)
    observations = environment.reset()["policy"][0]
    height = environment.chunks[0].drive.qpos[0, 2]
    np.testing.assert_allclose(observations[-187:], height - SCAN_OFFSET, rtol=1e-5)


def test_names_are_unique_and_complete(make):
    layout = make(simulations=1).layout
    for parts in (tuple(PARTS), ("proprioception",)):
        names = column_names(parts, layout)
        assert len(set(names)) == len(names) == size(parts, layout)
    assert [c[1] for c in columns(("proprioception",), layout)] == [3, 3, 3, 14, 14, 14, 14]
