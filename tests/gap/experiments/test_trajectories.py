import numpy as np
import pytest

from hyperleg_design.gap.experiments import trajectories
from hyperleg_design.gap.experiments.rig_room import Room

RATE = 200.0


@pytest.fixture(scope="module")
def room():
    return Room(
        centre=np.array([0.1, -0.4]),
        low=np.array([-0.6, -1.1]),
        high=np.array([0.9, 0.2]),
        speed=np.array([3.0, 1.5]),
        acceleration=np.array([60.0, 25.0]),
    )


def shapes(room):
    time = np.arange(2001) / RATE
    return {
        "chirp": trajectories.chirp(time, room, 0.1, 15.0),
        "sweeps": trajectories.sweeps(RATE, room, (0.5, 2.0), (0.4, 0.9)),
        "ramps": trajectories.ramps(RATE, room, (0.1, 0.4)),
        "holds": trajectories.holds(RATE, room, 3),
        "reversals": trajectories.reversals(
            RATE, room, [room.centre, room.centre + 0.1], (0.02, 0.08)
        ),
        "fourier": trajectories.fourier(time, room, 0.1, 6, np.linspace(0, 9, 12).reshape(6, 2)),
    }


@pytest.mark.parametrize("name", ["chirp", "sweeps", "ramps", "holds", "reversals", "fourier"])
def test_starts_and_ends_at_rest_in_the_centre_and_stays_inside(room, name):
    motion = shapes(room)[name]
    velocity = np.diff(motion, axis=0) * RATE
    assert np.allclose(motion[[0, -1]], room.centre, atol=1e-6)
    assert np.abs(velocity[[0, -1]]).max() < 0.05 * np.abs(velocity).max()
    assert (motion >= room.low - 1e-9).all()
    assert (motion <= room.high + 1e-9).all()
    assert (np.abs(velocity).max(0) <= 1.1 * room.speed).all()
    assert np.abs(velocity).max(0).min() > 0.01


def test_chirp_sweeps_from_slow_to_fast(room):
    time = np.arange(4001) / RATE
    motion = trajectories.chirp(time, room, 0.1, 10.0) - room.centre
    crossings = [
        np.count_nonzero(np.diff(np.sign(motion[part, 0])))
        for part in (slice(200, 1000), slice(3000, 3800))
    ]
    assert crossings[0] <= 4
    assert crossings[1] > 20


def test_chirp_keeps_its_acceleration_at_all_frequencies(room):
    time = np.arange(20001) / 1000
    motion = trajectories.chirp(time, room, 0.1, 15.0)
    acceleration = np.gradient(np.gradient(motion, time, axis=0), time, axis=0)
    assert (np.abs(acceleration).max(0) <= 1.05 * room.acceleration).all()
    late = np.abs(acceleration[15000:18000]).max(0)
    assert (late > 0.6 * room.acceleration).all()


def test_ramps_hold_their_speeds(room):
    speed = np.abs(np.diff(trajectories.ramps(RATE, room, (0.1, 0.4)), axis=0) * RATE)
    fastest = speed[:, 0]
    counts = [np.mean(np.abs(fastest - s) < 0.005) for s in (0.1, 0.4)]
    assert min(counts) > 0.1
    assert sum(counts) > 0.8


def test_holds_come_to_each_posture_from_both_sides(room):
    motion = trajectories.holds(RATE, room, 3, dwell=0.5)
    rest = np.concatenate([[False], np.all(np.diff(motion, axis=0) == 0, 1)])
    starts = np.flatnonzero(rest[1:] & ~rest[:-1]) + 1
    starts = [s for s in starts if rest[s : s + 60].all() and s > 10]
    came = [np.sign(motion[s - 1] - motion[s - 30])[0] for s in starts[:6]]
    places = [tuple(np.round(motion[s + 5], 6)) for s in starts[:6]]
    assert places[0] == places[1]
    assert came[0] == -came[1]
    assert len(set(places)) == 3


def test_reversals_turn_round_often_at_each_posture(room):
    motion = trajectories.reversals(
        RATE, room, [room.centre, room.centre + 0.2], (0.03,), strokes=6
    )
    moved = np.diff(motion[:, 0])
    signs = np.sign(moved[np.abs(moved) > 1e-6])
    assert np.count_nonzero(np.diff(signs)) >= 10


def test_spread_fills_the_cube_evenly():
    points = trajectories.spread(256, 3)
    assert np.abs(points).max() <= 1
    assert np.abs(points.mean(0)).max() < 0.05
    assert points.std(0) == pytest.approx(1 / np.sqrt(3), rel=0.05)
