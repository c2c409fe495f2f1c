"""Feet of other people's robots: the outermost links that touch the ground."""

from __future__ import annotations

import mujoco
import numpy as np

from hyperleg_design.gap.model.feet import feet_of, pads_of
from hyperleg_design.gap.model.mechanism import mechanism_of

TEXT = """<mujoco><worldbody><body name="trunk"><freejoint/>
  <geom type="box" size="0.2 0.1 0.05" mass="4"/>
  <body name="thigh"><joint name="hip" axis="0 1 0"/>
    <geom name="knee_bumper" size="0.03" pos="0 0 -0.2" mass="1"/>
    <geom type="capsule" size="0.02" fromto="0 0 0 0 0 -0.2" mass="1"/>
    <body name="shank" pos="0 0 -0.2"><joint name="knee" axis="0 1 0"/>
      <geom name="sole" type="box" size="0.05 0.03 0.01" pos="0 0 -0.2" mass="1"/></body></body>
  <body name="tail"><joint name="wag" axis="0 0 1"/>
    <geom size="0.02" mass="0.1" contype="0" conaffinity="0"/></body>
</body></worldbody></mujoco>"""


def test_a_foot_is_the_outermost_link_that_touches_with_the_spheres_of_its_limb():
    model = mujoco.MjModel.from_xml_string(TEXT)
    tree = mechanism_of(model)
    feet, pads = feet_of(model, tree)
    assert feet == ("shank",)  # the tail touches nothing, the trunk is no limb
    names = [pad.name for pad in pads]
    assert names == ["knee_bumper", *(f"sole_{corner}" for corner in range(8))]
    assert {pad.foot for pad in pads} == {0}
    corners = np.array([pad.position for pad in pads[1:]])
    np.testing.assert_allclose(np.abs(corners - [0, 0, -0.2]), np.tile([0.05, 0.03, 0.01], (8, 1)))


def test_all_that_collides_is_a_pad_where_nobody_names_feet():
    model = mujoco.MjModel.from_xml_string(TEXT)
    tree = mechanism_of(model)
    pads = pads_of(model, tree)
    links = {tree.links[pad.link] for pad in pads}
    assert links == {"trunk", "thigh", "shank"}
    capsule = [pad for pad in pads if pad.name.startswith("thigh")]
    assert [round(pad.position[2], 6) for pad in capsule] in ([0.0, -0.2], [-0.2, 0.0])
