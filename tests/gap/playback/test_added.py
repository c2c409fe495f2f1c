"""What an added effect changes: replays of logs, and walks."""

from __future__ import annotations

import diagnosed
import mujoco
import numpy as np
import pytest

from hyperleg_design.evaluation.protocol import (
    load_protocol,
    protocol_from_mapping,
    protocol_mapping,
)
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.playback import added
from hyperleg_design.gap.playback.overlay import Overlay
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.report.gap.text import changed_text, replayed_text

TRUE = Overlay("coupled", {("viscous_friction", "knee"): {"damping": 0.3}})
WRONG = Overlay("coupled", {("viscous_friction", "hip"): {"damping": 0.3}})


@pytest.fixture(scope="module")
def signals(robot_files):
    return diagnosed.conditioned(robot_files["coupled"], diagnosed.run("viscous", 3))


def test_the_true_effect_makes_replays_better_and_a_wrong_one_does_not(signals):
    rows = {row.joint: row for row in added.replayed(signals, TRUE)}
    assert rows["knee"].after < 0.3 * rows["knee"].before
    assert rows["knee"].windows > 20
    worse = {row.joint: row for row in added.replayed(signals, WRONG)}
    assert worse["knee"].after > 0.5 * worse["knee"].before
    text = replayed_text(list(rows.values()))
    assert "knee" in text
    assert replayed_text([]) == changed_text([]) == ""


def test_a_mapping_has_no_nan(signals):
    rows = added.replayed(signals, TRUE)
    nan = float("nan")
    told = added.mapping(rows, [added.Changed("time", "s", 15.0, nan, nan, nan, nan, 0)])
    assert told["walked"][0]["after"] is None
    assert told["replayed"][0]["joint"] == rows[0].joint


@pytest.mark.slow
def test_a_stiff_knee_costs_a_walk_energy():
    short = protocol_from_mapping({**protocol_mapping(load_protocol("walk")), "trials": 2}, "short")
    overlay = Overlay(
        "hyperleg",
        {
            ("coulomb_friction", "left_knee"): {"torque": 3.0},
            ("coulomb_friction", "right_knee"): {"torque": 3.0},
        },
    )
    rows = {
        row.measure: row for row in added.walked("walk_upright-toe-1", overlay, short, workers=1)
    }
    assert rows["power"].difference > 0
    assert np.isclose(rows["power"].difference, rows["power"].after - rows["power"].before)
    assert rows["power"].low < rows["power"].difference < rows["power"].high


ARM = """<mujoco><option timestep="0.001"/><worldbody><body>
<joint name="j" axis="0 1 0" damping="0.2"/>
<geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.02" mass="1"/></body></worldbody>
<actuator><motor name="j" joint="j" ctrlrange="-20 20"/></actuator></mujoco>"""


def followed(folder, every):
    """Log at 200 Hz of a joint that follows a wave; it gets a target every so many milliseconds."""
    (folder / "arm.xml").write_text(ARM)
    model = mujoco.MjModel.from_xml_path(str(folder / "arm.xml"))
    data, rows = mujoco.MjData(model), []
    for tick in range(4000):
        wanted = 0.5 * np.sin(6 * 0.001 * (tick // every * every))
        data.ctrl[0] = 40 * (wanted - data.qpos[0]) - 1.0 * data.qvel[0]
        if tick % 5 == 0:
            rows.append([tick * 0.001, wanted, data.qpos[0], data.qvel[0]])
        mujoco.mj_step(model, data)
    time, target, position, velocity = np.array(rows).T
    signals = {"position_target/j": target, "position/j": position, "velocity/j": velocity}
    log = Log("run", time, signals, Metadata(gains={"j": (40.0, 1.0)}, base="fixed"))
    return condition(log, load_subject(folder / "arm.xml", [log]))


@pytest.mark.parametrize(("every", "way"), [(1, "moving evenly"), (5, "kept from row to row")])
def test_what_a_target_does_between_rows_is_found_out(tmp_path, every, way):
    none = Overlay("arm", {("viscous_friction", "j"): {"damping": 0.0}})
    (row,) = added.replayed([followed(tmp_path, every)], none)
    assert way in row.follows
    assert row.before < 5e-4
