"""An import says which default angles it assumed, and writes them as such."""

from __future__ import annotations

import json
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.cli import main
from hyperleg_design.robot.assumed_posture import nearest_to_zero
from hyperleg_design.robot.description import urdf
from hyperleg_design.robot.load import load_robot
from tests.robot.test_importing import LEG, actuation
from tests.robot.tree_files import leg


@given(*2 * [st.floats(-720, 720)])
def test_the_assumed_angle_is_in_the_range_and_near_its_end(first, second):
    lower, upper = sorted((first, second))
    angle = nearest_to_zero(lower, upper)
    assert lower <= angle <= upper
    assert abs(angle) - min(abs(lower), abs(upper)) * (lower > 0 or upper < 0) <= 0.01 + 1e-9


@pytest.mark.parametrize(
    ("lower", "upper", "default"),
    [
        (-2.443, -0.34906585039900006, -20.0),
        (0.34906585039900006, 2.443, 20.0),
        (0.5, 2.0, 28.65),
        (0.5, 0.50001, 28.647889757),
        (-1.0, 1.0, 0.0),
    ],
)
def test_a_posture_that_nobody_states_is_assumed_and_round(lower, upper, default, tmp_path, capsys):
    path, out = tmp_path / "leg.urdf", tmp_path / "leg.yaml"
    text = urdf(leg())
    text = re.sub('lower="[^"]*"', f'lower="{lower}"', text, count=1)
    path.write_text(re.sub('upper="[^"]*"', f'upper="{upper}"', text, count=1))
    motors = actuation(tmp_path / "m.yaml", actuators=LEG, joints={"knee": {"default_deg": 7}})
    assert main(["import", str(path), "--actuation", str(motors), "--out", str(out)]) == 0
    (line,) = [x for x in capsys.readouterr().out.splitlines() if x.startswith("default_deg")]
    assert "assumed for 1 joint as" in line
    assert (f"hip {default:g};" in line) is bool(default)
    design = load_robot(out)
    assert design["joints.hip.default_deg"] == default
    assert design["joints.knee.default_deg"] == 7
    assert design.origins["joints.hip.default_deg"].label == "assumed"
    assert design.origins["joints.knee.default_deg"].label == "user"


def test_no_posture_is_assumed_where_all_are_stated(tmp_path, capsys):
    path = tmp_path / "leg.urdf"
    path.write_text(urdf(leg()))
    motors = actuation(tmp_path / "m.yaml", actuators=LEG, joints={"*": {"default_deg": 7}})
    assert main(["import", str(path), "--actuation", str(motors)]) == 0
    assert "assumed" not in capsys.readouterr().out
    assert main(["import", str(path), "--actuation", str(motors), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["assumed_default_deg"] == {}
