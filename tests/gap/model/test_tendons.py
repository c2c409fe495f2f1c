"""Tendons of other people's MJCF, against MuJoCo's own inverse dynamics."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hyperleg_design.gap.model.oracle import disagreements, mujoco_torques
from hyperleg_design.gap.model.rigid import inverse_dynamics
from hyperleg_design.gap.playback.plant import motor_tendons
from hyperleg_design.gap.signals.loading import load_subject

ARM = """<mujoco><compiler angle="radian"/><option gravity="0 0 -9.81"/><worldbody>
<body name="a"><joint name="j" axis="0 1 0" range="-1 1" {j}/><geom size="0.05" pos="0.1 0 0" mass="1"/>
<body name="b" pos="0.3 0 0"><joint name="k" axis="0 1 0" range="-1 1" {k}/>
<geom size="0.05" pos="0.1 0 0" mass="0.5"/></body></body></worldbody>
<tendon>{tendons}</tendon><actuator>{actuators}</actuator></mujoco>"""  # noqa: E501
SINGLE = '<fixed name="t" {}><joint joint="j" coef="-2"/></fixed>'
BOTH = '<fixed name="t" {}><joint joint="j" coef="1.5"/><joint joint="k" coef="-0.7"/></fixed>'
OTHER = '<fixed name="u" {}><joint joint="k" coef="3"/></fixed>'
ON_T, ON_K = '<motor name="m" tendon="t" gear="{}"/>', '<motor name="n" joint="k"/>'


@pytest.fixture
def arm(tmp_path: Path):
    def written(tendons: str, actuators: str, j: str = "", k: str = ""):
        path = tmp_path / "arm.xml"
        path.write_text(ARM.format(tendons=tendons, actuators=actuators, j=j, k=k))
        return load_subject(path)

    return written


CASES = {
    "gear on a single joint": (
        SINGLE.format('armature="0.0096"'),
        ON_T.format(32.06) + ON_K,
    ),
    "gear on coupled joints": (BOTH.format('armature="0.0096"'), ON_T.format(32.06) + ON_K),
    "two actuators on one tendon": (
        BOTH.format('armature="0.02"'),
        ON_T.format(3) + '<motor name="o" tendon="t" gear="2"/>' + ON_K,
    ),
    "tendon that nothing pulls": (
        BOTH.format('armature="0.03"'),
        '<motor joint="j" gear="7"/>' + ON_K,
    ),
    "single tendon that nothing pulls beside coupled motors": (
        BOTH.format('armature="0.01"') + OTHER.format('armature="0.004"'),
        ON_T.format(5) + ON_K,
    ),
    "friction and a spring on one joint": (
        SINGLE.format('damping="0.4" stiffness="3" springlength="0.2" armature="0.01"'),
        ON_T.format(4) + ON_K,
    ),
    "a tendon's spring beside the joint's own": (
        SINGLE.format('stiffness="3" springlength="0.2"'),
        ON_T.format(4) + ON_K,
    ),
    "armature of an actuator": (
        SINGLE.format('armature="0.001"'),
        '<motor name="m" joint="j" gear="20" armature="0.0001"/>' + ON_K,
    ),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("own", ["", 'armature="0.05" damping="0.3" stiffness="2" springref="0.1"'])
def test_read_as_mujoco_reads_them(arm, case, own):
    subject = arm(*CASES[case], j=own, k='armature="0.02" damping="0.1"')
    assert not [note for note in subject.notes if "differ" in note or "left out" in note]


def test_armature_of_a_tendon_is_not_multiplied_by_the_gear(arm):
    tendon = '<fixed name="t" armature="0.0096"><joint joint="j" coef="1"/></fixed>'
    subject = arm(tendon, ON_T.format(32.06) + ON_K)
    assert subject.armature[0, 0] == pytest.approx(0.0096)
    both = arm(BOTH.format('armature="0.0096"'), ON_T.format(32.06) + ON_K)
    row = np.array([1.5, -0.7])
    np.testing.assert_allclose(both.armature, 0.0096 * np.outer(row, row), atol=1e-15)
    assert both.rotor_inertia[0] == pytest.approx(0.0096 / 32.06**2)


def test_dry_friction_of_a_single_tendon_is_the_joints(arm):
    subject = arm(SINGLE.format('frictionloss="0.5"'), ON_T.format(4), j='frictionloss="0.1"')
    assert subject.coulomb.tolist() == pytest.approx([1.1, 0.0])


def test_the_replay_model_has_the_same_inertia(arm):
    for tendons, actuators in CASES.values():
        subject = arm(tendons, actuators)
        rng = np.random.default_rng(1)
        q, v, a = rng.uniform(-0.5, 0.5, (3, 4, 2))
        theirs = mujoco_torques(subject.model, subject.joints, q, v, a)
        ours = inverse_dynamics(subject, q, v, a) + subject.spring * (q - subject.spring_rest)
        np.testing.assert_allclose(theirs, ours, atol=1e-9)


def test_tendons_beside_the_motors_come_last(arm):
    tendons = '<fixed name="x" armature="0.2"><joint joint="j" coef="1"/><joint joint="k" coef="1"/></fixed>'  # noqa: E501
    subject = arm(tendons + BOTH.format('armature="0.01"'), ON_T.format(5) + ON_K)
    assert motor_tendons(subject) == len(subject.motors) == 2
    assert subject.model.ntendon == 3


def test_a_spring_that_couples_joints_is_said_to_be_left_out(arm):
    subject = arm(BOTH.format('stiffness="4" springlength="0"'), ON_T.format(4) + ON_K)
    text = "; ".join(subject.notes)
    assert "tendon t couples joints: its friction and spring are left out" in text
    assert "torques differ from MuJoCo's inverse dynamics of the whole file at j, k" in text


def test_gravity_compensation_is_noticed(tmp_path):
    path = tmp_path / "light.xml"
    text = ARM.format(tendons="", actuators=ON_K, j="", k="").replace(
        '<body name="b"', '<body name="b" gravcomp="1"'
    )
    path.write_text(text.replace("<tendon></tendon>", ""))
    assert "gravity compensation" in "; ".join(load_subject(path).notes)


def test_a_right_reading_has_no_note(arm):
    import mujoco

    subject = arm(BOTH.format('armature="0.01"'), ON_T.format(5) + ON_K)
    assert disagreements(subject, mujoco.MjModel.from_xml_path(subject.path)) == ()
