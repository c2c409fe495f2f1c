import numpy as np
import pytest

from hyperleg_design.validation.blind.drawing import draw
from hyperleg_design.validation.blind.plants.nuisance import of_day, of_robot
from hyperleg_design.validation.blind.plants.rig_build import Reach, build_rig
from hyperleg_design.validation.blind.robots.catalogue import ROBOTS, chain
from hyperleg_design.validation.blind.truth import parameters, places
from hyperleg_design.validation.blind.wrong import SIZES, Wrong


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("effect", sorted(SIZES))
def test_every_effect_changes_every_robot_and_says_what_it_is(name, effect):
    robot, rng = chain(name), np.random.default_rng(0)
    if name == "servo" and effect == "cross_coupling":
        return
    day = of_day(robot, of_robot(robot, rng), rng)
    reach = Reach(robot.peak_torque * 0.5, robot.no_load_speed * 0.3)
    drawn = draw(robot, effect, rng)
    wrong = Wrong(effect, drawn.location, drawn.size * SIZES[effect].largest * 0.9, drawn.shape)
    before, after = build_rig(robot, day, (), reach), build_rig(robot, day, [wrong], reach)
    same = all(
        np.array_equal(getattr(before, k), getattr(after, k)) for k in vars(before) if k != "model"
    )
    bodies = [
        np.concatenate([i.toDynamicParameters() for i in list(p.model.inertias)[1:]])
        for p in (before, after)
    ]
    unmoved = np.array_equal(*bodies) and np.array_equal(
        before.model.gravity.linear, after.model.gravity.linear
    )
    assert not (same and unmoved)
    values = parameters(wrong, robot, day, reach)
    assert all(np.isfinite(v) for v in values.values())
    # where the line of the motors is nobody's knowledge, how far it falls has no number to be
    # compared with
    assert bool(values) == (
        wrong.listed and not (effect == "voltage_sag" and robot.mjcf is not None)
    )
    assert wrong.location in places(wrong, robot)
