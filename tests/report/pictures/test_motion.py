"""Animations show the recorded motion: places, directions and forces as they were."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.protocol import TTestProtocol
from hyperleg_design.report.pictures import motion
from hyperleg_design.report.pictures.solids import PAD


@pytest.fixture(scope="module")
def walk(walks):
    return walks["toe"]


def test_a_walk_moves_as_it_was_recorded(walk):
    made = motion.walk_motion(walk, begin=2.0, duration=2.0, frames_per_second=10.0)
    assert len(made.focus) == 20
    pelvis = made.positions[:, 0]
    speed = np.diff(pelvis[[0, -1], 0])[0] / 1.9
    assert speed == pytest.approx(walk.base_velocity[:, 0].mean(), rel=0.05)
    samples = (np.arange(2.0, 4.0, 0.1) / walk.time_step).round().astype(int)
    assert made.focus[:, 0] == pytest.approx(
        walk.base_position[samples, 0] - walk.base_position[0, 0], abs=0.2
    )


def test_pads_stand_on_the_floor(walk):
    made = motion.walk_motion(walk, begin=2.0, duration=1.0)
    pads = [i for i, solid in enumerate(made.solids) if solid.colour == PAD]
    lowest = (made.positions[:, pads, 2] - made.solids[pads[0]].size[0]).min(1)
    assert np.abs(lowest).max() < 0.01


def test_the_direction_of_a_walk_does_not_matter(walk):
    angle = 2.0
    level = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    w, x, y, z = walk.base_orientation.T
    c, s = np.cos(angle / 2), np.sin(angle / 2)
    turned = dataclasses.replace(
        walk,
        base_position=walk.base_position @ level.T + [3.0, -4.0, 0.0],
        base_orientation=np.stack([c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w], -1),
    )
    one, other = (motion.walk_motion(trial, begin=1.0, duration=1.0) for trial in (walk, turned))
    assert one.positions == pytest.approx(other.positions, abs=1e-6)
    assert one.rotations == pytest.approx(other.rotations, abs=1e-6)


def test_a_t_test_is_followed_over_its_course(course_run):
    protocol = TTestProtocol()
    made = motion.t_test_motion(course_run, protocol, most_frames=30)
    assert len(made.focus) in (30, 31)
    assert [text for _, text, _ in made.labels] == list(protocol.points)
    far = np.linalg.norm(made.positions[:, 0, :2] - made.focus[:, :2], axis=-1)
    assert far.max() < 2.5
    assert len([line for line in made.lines if line[3] == 3.0]) == len(protocol.order) - 1


def test_nothing_to_show_is_told(walk):
    empty = dataclasses.replace(walk, base_position=np.empty((0, 3)))
    with pytest.raises(InputError, match="no samples"):
        motion.walk_motion(empty)
