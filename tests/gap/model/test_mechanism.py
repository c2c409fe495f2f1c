import mujoco
import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.model.mechanism import (
    inertial_parameters,
    mass_properties,
    mechanism_of,
    moved_inertial,
    quaternion_rotation,
)
from hyperleg_design.gap.signals.loading import load_subject


def test_mass_of_the_tree_is_mass_of_the_model():
    subject = load_subject("hyperleg")
    total = subject.tree.base_inertial[0] + subject.tree.inertial[:, 0].sum()
    assert total == pytest.approx(subject.model.body_mass.sum(), rel=1e-12)
    assert subject.tree.link_inertial[:, 0].sum() == pytest.approx(total, rel=1e-12)


def test_ends_of_a_robot_carry_nothing():
    tree = load_subject("hyperleg").tree
    carried = {
        link: tree.beyond(link)
        for link in ("left_toe_plate", "left_foot", "left_shank", "left_thigh")
    }
    assert carried["left_toe_plate"] == 0
    assert carried["left_foot"] == 1
    assert 1 < carried["left_shank"] < carried["left_thigh"]
    assert tree.beyond("left_toe") == 0  # a joint stands for what it carries
    assert tree.beyond("pelvis") == 0
    assert tree.beyond("no such link") == 1


def test_inertial_parameters_move_there_and_back():
    rng = np.random.default_rng(0)
    root = rng.normal(size=(3, 3))
    parameters = inertial_parameters(2.5, rng.normal(size=3), root @ root.T + 3 * np.eye(3))
    rotation, offset = quaternion_rotation(rng.normal(size=4)), rng.normal(size=3)
    moved = moved_inertial(parameters, rotation, offset)
    np.testing.assert_allclose(
        moved_inertial(moved, rotation.T, -rotation.T @ offset), parameters, atol=1e-12
    )
    # what does not depend on the frame
    for one, two in ((mass_properties(parameters), mass_properties(moved)),):
        assert one[0] == two[0]
        np.testing.assert_allclose(
            np.linalg.eigvalsh(one[2]), np.linalg.eigvalsh(two[2]), rtol=1e-12
        )


@pytest.mark.parametrize(
    ("joint", "wrong"),
    [
        ('<joint name="j" type="ball"/>', "ball"),
        ('<joint name="k"/></body><body><freejoint/><joint name="j"/>', None),
    ],
)
def test_what_is_not_understood_is_refused(joint, wrong):
    text = f'<mujoco><worldbody><body>{joint}<geom size="0.1"/></body></worldbody></mujoco>'
    if wrong is None:
        text = '<mujoco><worldbody><body><geom size="0.1"/><freejoint/></body></worldbody></mujoco>'
    with pytest.raises(InputError):
        mechanism_of(mujoco.MjModel.from_xml_string(text))


def test_several_joints_in_one_body_slides_and_references():
    text = """<mujoco><worldbody><body quat="0.9 0.1 0.3 -0.2">
      <joint name="x" type="slide" axis="1 1 0" ref="0.2"/><joint name="a" axis="0 1 1" pos="0.1 0 0.2" ref="0.3"/><joint name="b" axis="1 0 0"/>
      <geom size="0.1" pos="0.1 0.2 0.3" density="900"/><body pos="0 0.2 0.1"><joint name="c" axis="0 0 1" pos="0.05 0 0"/>
      <geom type="box" size="0.1 0.2 0.05" pos="0.1 0 0"/></body></body></worldbody></mujoco>"""  # noqa: E501
    from hyperleg_design.gap.model import rigid
    from hyperleg_design.gap.model.subject import Subject

    model = mujoco.MjModel.from_xml_string(text)
    tree = mechanism_of(model)
    rng = np.random.default_rng(3)
    q, v, a = rng.normal(size=(3, 4, 4))
    subject = Subject(
        **dict.fromkeys(Subject.__dataclass_fields__)
        | {"tree": tree, "gravity": model.opt.gravity, "base": "fixed"}
    )
    torque = rigid.inverse_dynamics(subject, q, v, a, rotors=False)
    data = mujoco.MjData(model)
    for tick in range(4):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[tick], v[tick], a[tick]
        mujoco.mj_inverse(model, data)
        np.testing.assert_allclose(torque[tick], data.qfrc_inverse, atol=1e-9)


def test_rotations_of_quaternions_are_mujocos_and_unknown_where_they_are():
    rng = np.random.default_rng(3)
    quaternions = rng.normal(size=(2, 5, 4))
    quaternions[1, 2, 0] = np.nan
    turned = quaternion_rotation(quaternions)
    assert turned.shape == (2, 5, 3, 3)
    assert np.isnan(turned[1, 2]).all()
    own = np.zeros(9)
    unit = quaternions[0, 1] / np.linalg.norm(quaternions[0, 1])
    mujoco.mju_quat2Mat(own, unit)
    np.testing.assert_allclose(turned[0, 1].ravel(), own, atol=1e-12)
