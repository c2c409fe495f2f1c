import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.load import load_robot
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.settings import Start
from hyperleg_design.simulation.terms.mirror import (
    mirror_joints,
    mirror_observation,
)
from hyperleg_design.simulation.terms.observations import PARTS, size


def mirror_position(qpos, qvel, layout):
    """MuJoCo states mirrored in the plane y = 0, `(..., 7 + J)` and `(..., 6 + J)`."""
    position, velocity, joints = qpos.copy(), qvel.copy(), mirror_joints(layout)
    position[..., [1, 4, 6]] *= -1  # y; quaternion x and z
    velocity[..., [1, 3, 5]] *= -1
    position[..., 7:], velocity[..., 6:] = joints(qpos[..., 7:]), joints(qvel[..., 6:])
    return position, velocity


@pytest.mark.parametrize("parts", [tuple(PARTS), ("proprioception",), ("clock", "waypoint")])
def test_mirroring_twice_gives_the_same(design, parts):
    layout = layout_of(design)
    mirrored = mirror_observation(parts, layout)
    values = np.random.default_rng(0).normal(size=(4, size(parts, layout)))
    np.testing.assert_array_equal(mirrored(mirrored(values)), values)
    assert sorted(mirrored.index) == list(range(size(parts, layout)))


@pytest.mark.parametrize(
    ("task", "variant"),
    [
        ("walk", "toe"),
        ("goal", "toe"),
        ("walk_paper", "toe_removed"),
        ("walk_any", "mini_cheetah"),
        ("walk_any", "parallel_ankle"),
        ("t_test_any", "mini_cheetah"),
    ],
)
def test_a_mirrored_robot_moves_as_the_mirror_image(design, make, task, variant):
    """Two simulations, one started as the mirror image of the other, with mirrored actions, stay
    mirror images.
    """
    environment = make(
        task,
        robot=load_robot(variant) if task.endswith("_any") else ablate(design, variant),
        simulations=2,
        seed=4,
        start=Start(joint_position=0.1, tilt=0.05),
    )
    environment.reset()
    maps = environment.mirror_maps()
    chunk = environment.chunks[0]
    position, velocity = mirror_position(
        chunk.drive.qpos[0], chunk.drive.qvel[0], environment.layout
    )
    chunk.drive.qpos[1], chunk.drive.qvel[1] = position, velocity
    _mirror_commands(chunk)
    chunk._clock_start[1] = chunk._clock_start[0] + 0.5
    rng = np.random.default_rng(0)
    for _ in range(15):
        action = rng.normal(size=environment.action_size) * 0.4
        step = environment.step(np.stack([action, maps["action"](action)]))
        for group, values in step.observations.items():
            np.testing.assert_allclose(values[1], maps[group](values[0]), atol=3e-4)
        np.testing.assert_allclose(step.reward_terms[1], step.reward_terms[0], atol=1e-4)
    assert np.all(step.ending == 0)
    assert chunk.sensors.any()


def test_hyperlegs_mirror_swaps_the_legs_and_keeps_signs(design):
    layout = layout_of(design)
    mirrored = mirror_joints(layout)
    np.testing.assert_array_equal(mirrored.index, np.roll(np.arange(14), 7))
    np.testing.assert_array_equal(mirrored.sign, 1.0)


def test_a_robot_that_is_not_its_own_image_has_no_mirror():
    robot = load_robot("mini_cheetah", overrides=["limbs.rear_left.position=[-0.25, 0.049, 0.0]"])
    with pytest.raises(InputError, match=r"not symmetric.*algorithm\.mirror"):
        mirror_joints(layout_of(robot))


def _mirror_commands(chunk):
    commander = chunk.commander
    if hasattr(commander, "values"):
        commander.values[0] = 0.8, 0.1, 0.3
        commander.values[1] = 0.8, -0.1, -0.3
        return
    for name in ("last", "target", "following"):
        points = getattr(commander, name)
        points[1] = points[0] * [1, -1]
    commander.best[1], commander.slower[1] = commander.best[0], commander.slower[0]
