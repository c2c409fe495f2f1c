from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import HyperlegError
from hyperleg_design.report.pictures import picture
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.design import load_design


@pytest.fixture(scope="module")
def design():
    return load_design("hyperleg")


def test_robot_stands_on_the_floor(design):
    for angles in ({}, {"left_knee": 1.0, "left_hip_pitch": -0.5, "left_ankle_pitch": -0.5}):
        pads = [s for s in picture.robot_solids(design, angles=angles) if s.colour == picture.PAD]
        assert min(s.position[2] - s.size[0] for s in pads) == pytest.approx(0, abs=1e-12)


def test_yaw_turns_the_robot_as_a_whole(design):
    plain, turned = picture.robot_solids(design), picture.robot_solids(design, yaw=0.7)
    steps = [
        np.linalg.norm(np.diff([s.position for s in solids], axis=0), axis=1)
        for solids in (plain, turned)
    ]
    assert np.allclose(steps[0], steps[1], atol=1e-12)
    assert not np.allclose([s.position for s in plain], [s.position for s in turned])


def test_only_installed_motors_are_drawn(design):
    counts = {}
    for name, variant in variants(design).items():
        with_motors = len(picture.robot_solids(variant, motors=True))
        counts[name] = with_motors - len(picture.robot_solids(variant, motors=False))
    assert counts == {"toe": 14, "toe_locked": 14, "toe_removed_matched": 12, "toe_removed": 12}


def test_scenes_name_the_design_numbers(design):
    texts = " ".join(label[1] for label in picture.dimensions_scene(design).labels)
    assert "thigh 370" in texts
    assert "height 958.6" in texts
    assert "pelvis 15.46 kg" in " ".join(label[1] for label in picture.masses_scene(design).labels)
    assert len(picture.frames_scene(design).arrows) == 14


def test_picture_is_drawn_and_not_blank(design, tmp_path):
    from PIL import Image

    try:
        path = picture.render(picture.variants_scene({"toe": design}), tmp_path / "robot.png")
    except HyperlegError as error:
        pytest.skip(f"no OpenGL here: {error}")
    pixels = np.asarray(Image.open(path).convert("RGB"), float)
    assert pixels.std() > 10


def test_a_machine_that_cannot_draw_gets_one_clear_error(design, tmp_path, monkeypatch):
    monkeypatch.setattr(picture.sys, "executable", "/bin/false")
    with pytest.raises(HyperlegError, match="cannot draw"):
        picture.render(picture.dimensions_scene(design), tmp_path / "x.png")
    assert not list(tmp_path.iterdir())
