import mujoco
import numpy as np
import pytest

from hyperleg_design.validation.blind.plants.nuisance import perfect
from hyperleg_design.validation.blind.plants.stand import Stand
from hyperleg_design.validation.blind.recorder import Recorder
from hyperleg_design.validation.blind.residual import rms
from hyperleg_design.validation.blind.robots.catalogue import chain
from hyperleg_design.validation.blind.walker import Floor, Walker
from hyperleg_design.validation.blind.walking_residual import walking_residual
from hyperleg_design.validation.blind.wrong import Wrong

STILL = Stand(0.0, 0.0, 0.0, 0.0, np.ones(5))
MOVING = Stand(0.22, 0.04, 0.04, 0.008, np.array([0.6, 0.4, 0.7, 0.5, 0.4]), spread=0.1, turn=0.1)


@pytest.fixture(scope="module")
def robot():
    return chain("hyperleg")


def test_motion_on_both_feet_balances_with_the_nominal_robot(robot):
    walker = Walker(robot, perfect(robot), Floor(1.0, 1.0, 1.0), Recorder())
    log = walker.log(walker.trace((), MOVING, 2.0, 0), 0, "x")
    assert log is not None
    left = walking_residual(log, robot)
    base = rms(left[:, :6])
    assert np.all(base[:3] < 2.0)  # of 313 N
    assert np.all(base[3:] < 1.5)
    assert np.ptp(log.column("base_position/z")) > 0.02


def test_a_load_on_the_pelvis_is_felt_by_the_ground(robot):
    walker = Walker(robot, perfect(robot), Floor(1.0, 1.0, 1.0), Recorder())
    weights = []
    for wrongs in ((), (Wrong("payload", "pelvis", 3.0, {"x": 0.0, "y": 0.0, "z": 0.1}),)):
        log = walker.log(walker.trace(wrongs, STILL, 1.0, 0), 0, "x")
        assert log is not None
        weights.append(
            sum(
                v[100:].mean()
                for k, v in log.signals.items()
                if k.startswith("contact_force") and k.endswith("_z")
            )
        )
    assert weights[1] - weights[0] == pytest.approx(3.0 * 9.81, rel=0.03)


@pytest.mark.slow
def test_smooth_ground_lets_feet_slip(robot):
    walker = Walker(robot, perfect(robot), Floor(1.0, 1.0, 1.0), Recorder())
    _, firm = walker.trace((), MOVING, 2.0, 0)
    _, slick = walker.trace((Wrong("ground_friction", "ground", 0.93, {}),), MOVING, 2.0, 0)
    hips = [np.ptp(t.encoder[:, 1] - t.encoder[:, 8]) for t in (firm, slick)]
    assert hips[1] > 1.2 * hips[0]  # legs spread farther where nothing holds the feet


def test_a_load_on_the_pelvis_is_a_point_mass_there(robot):
    walker, place = (
        Walker(robot, perfect(robot), Floor(1.0, 1.0, 1.0), Recorder()),
        [0.1, -0.05, 0.2],
    )
    load = Wrong("payload", "pelvis", 3.0, dict(zip("xyz", place, strict=True)))
    matrices = []
    for wrongs in ((), (load,)):
        model = walker.plant(wrongs).model
        data = mujoco.MjData(model)
        data.qpos[3:7] = [0.8, 0.0, 0.6, 0.0]
        mujoco.mj_forward(model, data)
        matrices.append(np.zeros((model.nv, model.nv)))
        mujoco.mj_fullM(model, data, matrices[-1])
    body = model.body("pelvis").id
    point = data.xpos[body] + data.xmat[body].reshape(3, 3) @ place
    at = np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, at, None, point, body)
    np.testing.assert_allclose(matrices[1] - matrices[0], 3.0 * at.T @ at, atol=1e-6)
