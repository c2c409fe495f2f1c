from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import HyperlegError
from hyperleg_design.report.pictures import picture, scenes
from hyperleg_design.robot.design import load_design


@pytest.fixture(scope="module")
def design():
    return load_design("hyperleg")


def test_picture_is_drawn_and_not_blank(design, tmp_path):
    from PIL import Image

    try:
        path = picture.render(scenes.variants_scene({"toe": design}), tmp_path / "robot.png")
    except HyperlegError as error:
        pytest.skip(f"no OpenGL here: {error}")
    pixels = np.asarray(Image.open(path).convert("RGB"), float)
    assert pixels.std() > 10


def test_a_machine_that_cannot_draw_gets_one_clear_error(design, tmp_path, monkeypatch):
    monkeypatch.setattr(picture.sys, "executable", "/bin/false")
    with pytest.raises(HyperlegError, match="cannot draw"):
        picture.render(scenes.dimensions_scene(design), tmp_path / "x.png")
    assert not list(tmp_path.iterdir())
