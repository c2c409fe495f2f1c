"""An arm that turns about vertical axes, in a plain MuJoCo loop: all that its drives work against
is friction, of which its model has none.
"""

import mujoco
import numpy as np
import pytest

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.pipeline.diagnose import diagnose

JOINTS = ("shoulder", "elbow")
MODEL = """
<mujoco model="scara">
  <compiler angle="radian"/>
  <option timestep="0.001" integrator="implicitfast"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <body>
      <joint name="shoulder" axis="0 0 1" {shoulder}/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03" mass="2"/>
      <body pos="0.3 0 0">
        <joint name="elbow" axis="0 0 1" {elbow}/>
        <geom type="capsule" fromto="0 0 0 0.25 0 0" size="0.025" mass="1"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="shoulder" joint="shoulder" ctrlrange="-60 60"/>
    <motor name="elbow" joint="elbow" ctrlrange="-30 30"/>
  </actuator>
</mujoco>
"""
COULOMB, VISCOUS, ROTOR = np.array([6.0, 3.0]), np.array([3.0, 1.5]), np.array([0.2, 0.1])
"""[Nm, Nms/rad, kg m^2]"""
GAINS = np.array([400.0, 200.0]), np.array([20.0, 10.0])
"""[Nm/rad, Nms/rad]"""
RAISED = 1.5
"""Friction of the elbow after it has been changed, over before [-]."""


def recorded(seed, friction=COULOMB):
    values = zip(friction, VISCOUS, ROTOR, strict=True)
    shoulder, elbow = (f'frictionloss="{c}" damping="{v}" armature="{a}"' for c, v, a in values)
    model = mujoco.MjModel.from_xml_string(MODEL.format(shoulder=shoulder, elbow=elbow))
    data, rng, rows = mujoco.MjData(model), np.random.default_rng(seed), []
    phase = rng.uniform(0, 2 * np.pi, (2, 3))
    turns = 2 * np.pi * np.array([[0.2, 0.5, 1.1], [0.3, 0.6, 1.3]])
    for tick in range(12_000):
        time = tick * 1e-3
        swing = np.array([0.6, 0.3, 0.12]) * np.sin(turns * time + phase)
        wanted = min(time, 1.0) * swing.sum(1)
        position = data.qpos + 1e-4 * rng.standard_normal(2)
        speed = data.qvel + 5e-3 * rng.standard_normal(2)
        data.ctrl[:] = GAINS[0] * (wanted - position) - GAINS[1] * speed
        if tick % 5 == 0:
            measured = data.ctrl + 0.05 * rng.standard_normal(2)
            rows.append([time, *wanted, *position, *speed, *measured])
        mujoco.mj_step(model, data)
    signals = ("position_target", "position", "velocity", "motor_torque")
    columns = [f"{signal}/{joint}" for signal in signals for joint in JOINTS]
    table = np.array(rows)
    gains = {joint: (k, d) for joint, k, d in zip(JOINTS, *GAINS, strict=True)}
    return Log(
        f"scara_{seed}",
        table[:, 0],
        dict(zip(columns, table[:, 1:].T, strict=True)),
        Metadata(base="fixed", gains=gains),
    )


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    path = tmp_path_factory.mktemp("scara") / "scara.xml"
    path.write_text(MODEL.format(shoulder="", elbow=""))
    return path


@pytest.fixture(scope="module")
def healthy():
    return [recorded(seed) for seed in (1, 2)]


def sizes(causes, effect):
    return {
        one.location: next(iter(one.parameters.values())).value
        for one in causes
        if one.effect == effect
    }


@pytest.mark.slow
def test_friction_that_is_all_of_the_torque_is_friction(model, healthy):
    """A rotor of the shoulder cannot be told from masses, as the arm bears no weight."""
    found = diagnose(model, healthy)
    assert found.verdict in ("explained", "ambiguous")
    alike = {effect for one in found.equivalent for effect, _ in one} | {"rotor_inertia"}
    assert {one.effect for one in found.causes} <= {"coulomb_friction", "viscous_friction"} | alike
    for effect, true in (("coulomb_friction", COULOMB), ("viscous_friction", VISCOUS)):
        own = dict(zip(JOINTS, true, strict=True))
        assert sizes(found.causes, effect) == pytest.approx(own, rel=0.06)


@pytest.mark.slow
def test_its_change_is_found_beside_what_the_model_lacks(model, healthy):
    raised = [recorded(seed, COULOMB * [1.0, RAISED]) for seed in (1, 2)]
    found = diagnose(model, raised, healthy)
    assert found.verdict == "explained"
    changed = sizes(found.causes, "coulomb_friction")
    assert changed == pytest.approx({"elbow": (RAISED - 1) * COULOMB[1]}, rel=0.06)
    assert len(found.causes) == 1
