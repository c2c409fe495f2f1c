import numpy as np
import pytest

from hyperleg_design.gap.experiments.motions import (
    LeftOut,
    Motion,
    best_phases,
    fitted,
    loaded_postures,
    recommended,
)
from hyperleg_design.gap.experiments.rig_room import room_of, use_of
from hyperleg_design.gap.signals.loading import load_subject

NAMES = ["chirp", "sweeps", "ramps", "holds", "reversals", "postures", "swing"]


@pytest.fixture(scope="module")
def pendulum(robot_files):
    return load_subject(str(robot_files["pendulum"]))


@pytest.fixture(scope="module")
def planned(pendulum):
    return recommended(pendulum, room_of(pendulum), 100.0, np.random.default_rng(0))


def test_a_hanging_pendulum_can_do_all(planned):
    motions, left = planned
    assert [m.name for m in motions] == NAMES
    assert not left


def test_all_stay_within_room_and_motors(pendulum, planned):
    room = room_of(pendulum)
    for motion in planned[0]:
        on = ~motion.off
        assert motion.use.fits(motion.duration > 3)
        assert (motion.position >= room.low - 1e-9).all()
        assert (motion.position <= room.high + 1e-9).all()
        assert np.allclose(motion.position[0], room.centre)
        assert use_of(pendulum, room, motion.position[on], 0.01).speed <= 1


def test_only_the_swing_lets_go_and_it_ends_so(planned):
    for motion in planned[0]:
        assert motion.off.any() == (motion.name == "swing")
        if motion.off.any():
            assert motion.off[-1]
            assert np.diff(motion.off.astype(int)).sum() == 1


def test_no_motion_is_left_where_the_motor_cannot_hold_the_robot(pendulum):
    room = room_of(pendulum)
    far = room.centre + 40 * np.sin(np.arange(2000) / 3)[:, None]
    found = fitted(pendulum, room, "wild", "", far, 0.005)
    assert isinstance(found, Motion | LeftOut)
    if isinstance(found, Motion):
        assert found.scale < 0.2


def test_an_arm_that_falls_does_not_swing(robot_files):
    import robots

    path = robot_files["arm"].parent / "ranged.xml"
    path.write_text(
        robots.without_missing_meshes(robots.ARM).replace(
            '<joint name="elbow"', '<joint name="elbow" range="-0.4 0.4"'
        )
    )
    subject = load_subject(str(path))
    motions, left = recommended(subject, room_of(subject), 50.0, np.random.default_rng(0))
    assert [one.name for one in left] == ["swing"]
    assert "fall" in left[0].why or "swing out" in left[0].why
    assert {m.name for m in motions} == set(NAMES) - {"swing"}


def test_loaded_postures_differ_in_what_gravity_asks(pendulum):
    heavy, light = loaded_postures(pendulum, room_of(pendulum))
    assert abs(np.sin(heavy[0])) > 3 * abs(np.sin(light[0]))


def test_phases_are_the_best_of_those_drawn_and_the_same_each_time(pendulum):
    room, time = room_of(pendulum), np.arange(500) / 25
    first, again = (best_phases(pendulum, room, time, np.random.default_rng(3)) for _ in range(2))
    assert np.array_equal(first, again)
