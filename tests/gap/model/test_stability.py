"""Modes of control loops against what algebra and other libraries say of them."""

import numpy as np
import pytest
from scipy.linalg import eigh

from hyperleg_design.gap.model.stability import Loops, inertia, modes
from hyperleg_design.gap.signals.loading import load_subject

ARM = """<mujoco><worldbody><body name="upper"><joint name="shoulder" type="hinge" axis="0 1 0" armature="0.02"/>
<inertial pos="0 0 -0.15" mass="1.2" diaginertia="0.02 0.02 0.001"/>
<body name="lower" pos="0 0 -0.3"><joint name="elbow" type="hinge" axis="0 1 0" armature="0.01"/>
<inertial pos="0 0 -0.12" mass="0.6" diaginertia="0.006 0.006 0.0005"/></body></body></worldbody>
<actuator><motor name="shoulder" joint="shoulder"/><motor name="elbow" joint="elbow"/></actuator></mujoco>"""  # noqa: E501
ONE = """<mujoco><worldbody><body name="arm"><joint name="hinge" type="hinge" axis="0 1 0" armature="0.02"/>
<inertial pos="0 0 0" mass="0.3" diaginertia="0.05 0.05 0.05"/></body></worldbody>
<actuator><motor name="hinge" joint="hinge"/></actuator></mujoco>"""  # noqa: E501
POSTURE = np.array([0.4, -0.9])


def subject(tmp_path, text):
    path = tmp_path / "robot.xml"
    path.write_text(text)
    return load_subject(path)


def loops(late, gains, joints=1, **options):
    late = np.atleast_1d(np.asarray(late, float))
    return Loops(
        late,
        np.zeros((len(late), joints)),
        np.tile(np.asarray(gains, float), (len(late), 1, 1)),
        **options,
    )


def test_the_inertia_is_that_of_mujoco(tmp_path):
    import mujoco

    arm = subject(tmp_path, ARM)
    data = mujoco.MjData(arm.model)
    data.qpos[:] = POSTURE
    mujoco.mj_forward(arm.model, data)
    full = np.zeros((2, 2))
    mujoco.mj_fullM(arm.model, data, full)
    assert inertia(arm, POSTURE) == pytest.approx(full, abs=1e-9)


def test_a_late_loop_is_unstable_from_the_delay_that_takes_its_phase(tmp_path):
    one = subject(tmp_path, ONE)
    mass, stiffness, damping = inertia(one, np.zeros(1)), 300.0, 6.0
    # |K + i w D| = J w^2, and the delay turns it by what damping leads
    b, c = damping**2 / mass[0, 0] ** 2, stiffness**2 / mass[0, 0] ** 2
    w = np.sqrt((b + np.sqrt(b**2 + 4 * c)) / 2)
    critical = np.arctan2(w * damping, stiffness) / w
    found = modes(
        one,
        mass,
        loops([critical, 0.9 * critical, 1.1 * critical], [[stiffness, damping]]),
        1.1 * w / (2 * np.pi),
    )
    assert found.found.all()
    assert found.frequency[0] == pytest.approx(w / (2 * np.pi), rel=1e-6)
    assert found.growth[0] == pytest.approx(0, abs=1e-6)
    assert found.growth[1] < 0 < found.growth[2]


def test_a_rotor_on_its_belt_rings_as_two_masses_on_a_spring_do(tmp_path):
    one = subject(tmp_path, ONE)
    mass, rotor = inertia(one, np.zeros(1)), 0.02
    spring = np.array([500.0, 4000.0])
    expected = np.sqrt(spring * mass[0, 0] / (rotor * 0.05)) / (2 * np.pi)
    for place, frequency in enumerate(expected):
        found = modes(
            one, mass, loops([0, 0], [[0.0, 0.0]], belt=0, spring=spring), 0.9 * frequency
        )
        assert found.found[place]
        assert found.frequency[place] == pytest.approx(frequency, rel=5e-3)
        assert found.growth[place] < 0
        # the two masses swing against each other, in inverse proportion: the stretch is 1 + I / J
        # of the joint's
        assert found.stretch[place] == pytest.approx(1 + 0.05 / rotor, rel=1e-2)


def test_undamped_modes_are_those_of_the_generalised_eigenproblem(tmp_path):
    arm = subject(tmp_path, ARM)
    mass, gains = inertia(arm, POSTURE), np.array([[400.0, 0.0], [150.0, 0.0]])
    squares, shapes = eigh(np.diag(gains[:, 0]), mass)
    for square, shape in zip(squares, shapes.T, strict=True):
        found = modes(arm, mass, loops(0.0, gains, joints=2), 1.05 * np.sqrt(square) / (2 * np.pi))
        assert found.frequency[0] == pytest.approx(np.sqrt(square) / (2 * np.pi), rel=1e-6)
        assert abs(np.vdot(found.shape[0], shape / np.linalg.norm(shape))) == pytest.approx(
            1, abs=1e-6
        )


def test_an_encoder_on_the_rotor_sees_the_belt_less_than_one_at_the_joint(tmp_path):
    one = subject(tmp_path, ONE)
    mass, gains = inertia(one, np.zeros(1)), [[300.0, 6.0]]
    joint, rotor = (
        modes(
            one,
            mass,
            loops([0.0015], gains, belt=0, spring=np.array([4000.0]), on_rotor=side),
            85.0,
        )
        for side in (False, True)
    )
    assert joint.found.all()
    assert rotor.found.all()
    assert rotor.growth[0] < joint.growth[0]  # a controller that sees its own rotor damps it


def test_what_is_no_root_is_not_told(tmp_path):
    one = subject(tmp_path, ONE)
    found = modes(one, inertia(one, np.zeros(1)), loops([0.0], [[0.0, 0.0]]), 50.0)
    assert not found.found.any()  # nothing holds the joint: there is no frequency
