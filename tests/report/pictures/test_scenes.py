"""Scenes state the numbers of the design."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.report.pictures import scenes
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot


def test_scenes_name_the_design_numbers():
    design = load_design("hyperleg")
    texts = " ".join(label[1] for label in scenes.dimensions_scene(design).labels)
    assert "thigh 370" in texts
    assert "height 958.6" in texts
    assert "pelvis 15.46 kg" in " ".join(label[1] for label in scenes.masses_scene(design).labels)
    assert len(scenes.frames_scene(design).arrows) == 14


@pytest.mark.parametrize("name", ["hyperleg", "mini_cheetah", "teaching_leg"])
def test_a_robot_of_any_size_fits_into_its_picture(name):
    scene = scenes.robot_scene(load_robot(name))
    ends = np.array([abs(s.position - scene.camera[1]) + s.reach for s in scene.solids])
    forward, _, up = np.array(scene.camera[0]) - scene.camera[1]
    tilt = np.arctan2(up, forward)
    assert (np.cos(tilt) * ends[:, 2] + np.sin(tilt) * ends[:, 0]).max() < scene.height / 2
    assert ends[:, 1].max() < scene.height / 2 * scene.size[0] / scene.size[1]
