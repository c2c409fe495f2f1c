"""Scenes state the numbers of the design."""

from __future__ import annotations

from hyperleg_design.report.pictures import scenes
from hyperleg_design.robot.design import load_design


def test_scenes_name_the_design_numbers():
    design = load_design("hyperleg")
    texts = " ".join(label[1] for label in scenes.dimensions_scene(design).labels)
    assert "thigh 370" in texts
    assert "height 958.6" in texts
    assert "pelvis 15.46 kg" in " ".join(label[1] for label in scenes.masses_scene(design).labels)
    assert len(scenes.frames_scene(design).arrows) == 14
