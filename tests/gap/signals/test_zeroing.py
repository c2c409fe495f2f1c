import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.zeroing import MOST, zero_spread

MASS, ARM, COULOMB = 0.6, 0.2, 0.05


def pendulum(folder, links=1, quat="1 0 0 0"):
    """One or two equal links that hang at zero, a point mass at the end of each."""
    inner = ""
    for number in reversed(range(links)):
        inner = (
            f'<body name="l{number}" pos="0 0 {-ARM * (number > 0)}" quat="{quat}">'
            f'<joint name="j{number}" axis="0 1 0" frictionloss="{COULOMB}"/>'
            f'<inertial pos="0 0 {-ARM}" mass="{MASS}" diaginertia="1e-6 1e-6 1e-6"/>{inner}</body>'
        )
        quat = "1 0 0 0"
    motors = "".join(f'<motor name="j{n}" joint="j{n}"/>' for n in range(links))
    path = folder / "pendulum.xml"
    path.write_text(f"<mujoco><worldbody>{inner}</worldbody><actuator>{motors}</actuator></mujoco>")
    return load_subject(path)


def log(subject, start=0.0, **more):
    time = 0.01 * np.arange(200)
    moved = np.where(time > 0.05, np.sin(time), 0.0)
    columns = {f"position/{joint}": start + moved for joint in subject.joints}
    return Log("test", time, {**columns, **{k: np.zeros(200) for k in more}})


def test_zero_of_a_hanging_pendulum_is_even_over_what_friction_holds(tmp_path):
    subject = pendulum(tmp_path)
    held = COULOMB / (MASS * 9.81 * ARM)
    assert zero_spread(log(subject), subject) == pytest.approx([held / np.sqrt(3)], rel=1e-3)


def test_zeros_of_two_links_are_those_of_postures_that_friction_holds(tmp_path):
    subject = pendulum(tmp_path, links=2)
    weight = MASS * 9.81 * ARM
    stiffness = weight * np.array([[3.0, 1.0], [1.0, 1.0]])
    torque = np.random.default_rng(0).uniform(-COULOMB, COULOMB, (100_000, 2))
    postures = np.linalg.solve(stiffness, torque.T)
    np.testing.assert_allclose(zero_spread(log(subject), subject), postures.std(1), rtol=0.01)


def test_much_friction_is_bounded(tmp_path):
    subject = pendulum(tmp_path)
    rough = dataclasses.replace(subject, coulomb=np.array([5.0]))
    assert zero_spread(log(subject), rough) == pytest.approx([MOST])


def test_encoders_that_were_not_set_there_have_no_such_spread(tmp_path):
    subject = pendulum(tmp_path)
    assert not zero_spread(log(subject, start=0.08), subject).any()
    held = log(subject, **{"position_target/j0": 0})
    assert not zero_spread(held, subject).any()


@pytest.mark.parametrize("quat", ["0 1 0 0", "0.7071 0 0.7071 0"])
def test_joints_that_do_not_hang_at_zero(tmp_path, quat):
    subject = pendulum(tmp_path, quat=quat)
    assert not zero_spread(log(subject), subject).any()


def test_floating_robots_do_not_hang(tmp_path):
    subject = SimpleNamespace(**{**vars(pendulum(tmp_path)), "floating": True})
    assert not zero_spread(log(subject), subject).any()
