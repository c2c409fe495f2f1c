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
    places = np.array([solid.position for solid in scene.solids])
    assert np.abs(places - scene.camera[1]).max() < scene.height / 2
