"""The nominal ground of a biped in MuJoCo: its contacts, edited and as they are."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.ground.ground_friction import ChangedGround
from hyperleg_design.gap.playback import show
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.nominal_ground import (
    floor_geoms,
    foot_bodies,
    foot_geoms,
    nominal_ground,
    pair_settings,
)
from hyperleg_design.simulation.alteration import edited


@pytest.fixture(scope="module")
def biped():
    return show._subject(None, True)


def test_edits_scale_the_contact_and_leave_the_other_foot(biped):
    changed = edited(
        biped.model, (effect("ground_friction").alteration("left_foot", np.array([0.5]), biped),)
    )
    own, other = (foot_geoms(biped.model, foot_bodies(biped, foot)) for foot in (0, 1))
    for geom in own:
        before, after = pair_settings(biped.model, geom), pair_settings(changed, geom)
        assert after[0][0] == pytest.approx(0.5 * before[0][0])
        assert after[0][1:].tolist() == before[0][1:].tolist()
        assert after[1].tolist() == before[1].tolist()
        assert after[2] == before[2]
    for geom in other:
        assert (
            pair_settings(changed, geom)[0].tolist() == pair_settings(biped.model, geom)[0].tolist()
        )
    assert len(floor_geoms(biped.model)) == 1
    same = edited(
        biped.model,
        (effect("ground_compliance").alteration("left_foot", np.array([1.0, 1.0]), biped),),
    )
    np.testing.assert_array_equal(same.geom_priority, biped.model.geom_priority)


def test_compliance_divides_the_spring_and_keeps_the_damping_ratio(biped):
    bodies = foot_bodies(biped, 0)
    soft = edited(biped.model, (ChangedGround(bodies, compliance=4.0, damping=0.5),))
    geom = foot_geoms(biped.model, bodies)[0]
    (time, ratio), (slow, less) = pair_settings(biped.model, geom)[1], pair_settings(soft, geom)[1]
    # k' goes with 1 / (T r)^2 and b' with 1 / T
    assert (slow * less) ** 2 / (time * ratio) ** 2 == pytest.approx(4.0)
    assert less == pytest.approx(0.5 * ratio)
    assert time / slow == pytest.approx(0.5 / np.sqrt(4.0))


def test_pads_push_and_never_pull(biped):
    _, law = nominal_ground(biped, ("left_foot", "left_toe_plate"))
    depth = np.array([[-1e-3, -1e-3], [1e-3, -1e-3], [1e-3, 1e-3]])
    still, lifting = law.force(depth, np.zeros((3, 2))), law.force(depth, np.full((3, 2), -10.0))
    assert still[0] == 0
    assert 0 < still[1] < still[2]
    assert not lifting.any()


@pytest.mark.parametrize("friction", [0.5, 1.0])
@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
def test_static_force_of_a_pad_is_mujocos(tmp_path, friction, cone):
    """A ball at rest on a plane sinks until the contact bears its weight."""
    import mujoco

    path = tmp_path / "ball.xml"
    path.write_text(
        f'<mujoco><option cone="{cone}"/><default><geom friction="{friction}"/></default>'
        '<worldbody><geom name="floor" type="plane" size="1 1 1"/><body name="hull" pos="0 0 '
        '0.5"><freejoint/>'
        '<inertial pos="0 0 0" mass="3" diaginertia="0.01 0.01 0.01"/><body name="sole"><joint '
        'name="j" axis="0 0 1" type="slide"/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/><geom type="sphere" '
        'size="0.1" mass="0"/></body></body></worldbody>'
        '<actuator><position joint="j" kp="5000" kv="50"/></actuator></mujoco>'
    )
    subject = load_subject(path)
    model = subject.model
    data = mujoco.MjData(model)
    data.qpos[2] = 0.1
    model.dof_damping[-1] = 50.0
    for _ in range(4000):
        data.qfrc_applied[-1] = -5000 * data.qpos[-1]
        mujoco.mj_step(model, data)
    depth = 0.1 - float(data.body("sole").xpos[2])
    _, law = nominal_ground(subject, ("sole",))
    assert law.force(np.array([[depth]]), np.zeros((1, 1)))[0] == pytest.approx(4 * 9.81, rel=0.02)
