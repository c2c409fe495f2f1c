import pytest

from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.sizing.contacts import contact_points, sole_pads
from hyperleg_design.sizing.postures import POSTURES, posture

DESIGNS = variants(load_design())


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("name", POSTURES)
def test_postures_stand_on_the_floor(variant, name):
    model = rigid_body_model(DESIGNS[variant])
    points = contact_points(model, posture(DESIGNS[variant], name, model))
    assert points[:, 2].min() == pytest.approx(0.0, abs=1e-9)
    on_floor = {
        p.row for p, point in zip(sole_pads(model.tree), points, strict=True) if point[2] < 1e-3
    }
    assert on_floor == ({"tip"} if name == "toe_off" else {"heel", "ball", "tip"})
