from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree

import mujoco
import numpy as np
import pytest

from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.report.gap.drawing import robot_svg, shapes_of, share_of

ARM = """
<mujoco><worldbody><body name="a" pos="0 0 0.3" euler="0 0 30">
  <joint name="pan" axis="0 0 1"/><inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/>
  <geom type="box" size="0.1 0.1 0.1"/>
  <body name="b" pos="0.1 0 0.2" euler="0 40 0"><joint name="lift" axis="0 1 0" pos="0 0.02 0"/>
    <inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/>
    <body name="c" pos="0 0 0.4"><joint name="slide" type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/></body></body>
</body></worldbody></mujoco>
"""


@pytest.fixture(scope="module")
def subject(tmp_path_factory: pytest.TempPathFactory):
    path = tmp_path_factory.mktemp("arm") / "arm.xml"
    path.write_text(ARM)
    return load_subject(path)


def test_joints_are_drawn_where_mujoco_has_them(subject) -> None:
    model = mujoco.MjModel.from_xml_string(ARM)
    data = mujoco.MjData(model)
    data.qpos[:] = subject.default
    mujoco.mj_kinematics(model, data)
    shapes = shapes_of(subject)
    np.testing.assert_allclose(shapes.places, data.xanchor, atol=1e-12)
    (box,) = shapes.parts
    np.testing.assert_allclose(box.mean(0), data.geom_xpos[0], atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(box - box.mean(0), axis=1), 0.1 * np.sqrt(3))


def test_the_largest_share_is_the_largest_and_reddest_and_named(subject) -> None:
    drawing = robot_svg(subject, {"lift": 0.7, "c": 0.2})
    ElementTree.fromstring(drawing)
    titles = re.findall(r"r=\"([0-9.]+)\" fill=\"(#\w+)\" .*?<title>(\w+): (\d+) %", drawing)
    assert {name: share for _, _, name, share in titles} == {
        "pan": "0",
        "lift": "70",
        "slide": "20",
    }
    assert max(titles, key=lambda row: float(row[0]))[1:3] == ("#c62828", "lift")
    assert "lift 70 %</text>" in drawing
    assert "pan 0 %</text>" not in drawing


def test_links_count_for_the_joint_that_carries_them(subject) -> None:
    assert share_of(subject, "slide", {"lift": 0.7, "c": 0.2}) == pytest.approx(0.2)
    assert share_of(subject, "lift", {"lift": 0.7, "c": 0.2}) == pytest.approx(0.7)


def test_names_do_not_stand_above_each_other(subject) -> None:
    drawing = robot_svg(subject, {"pan": 0.4, "lift": 0.3, "slide": 0.3})
    places = [
        (float(x), float(y))
        for x, y in re.findall(r"<text x=\"([0-9.]+)\" y=\"([0-9.]+)\"", drawing)
    ]
    assert len(places) == 3
    for i, (x, y) in enumerate(places):
        assert all(x != other or abs(y - z) >= 14 for other, z in places[:i])
