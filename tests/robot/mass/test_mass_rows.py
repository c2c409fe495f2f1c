from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.mass.mass_rows import mass_rows
from hyperleg_design.robot.masses import mass_table
from hyperleg_design.robot.models import rigid_body_model


@pytest.fixture(scope="module")
def rows(hyperleg):
    return {(row.kind, row.name): row for row in mass_rows(hyperleg)}


def test_segments_are_the_papers(rows):
    printed = {"pelvis": 15.46, "thigh": 5.71, "shank": 1.68, "foot": 0.66, "toe": 0.22}
    for name, mass in printed.items():
        assert rows["segment", name].mass == pytest.approx(mass, abs=1e-12)
    assert rows["leg", "leg"].mass == pytest.approx(8.27, abs=1e-12)
    assert rows["robot", "robot"].mass == pytest.approx(32.0, abs=1e-12)


@pytest.mark.parametrize("kind", ["segment", "link"])
def test_parts_add_up_to_the_robot(hyperleg, rows, kind):
    total = sum(row.count * row.mass for (k, _), row in rows.items() if k == kind)
    assert total == pytest.approx(mass_table(hyperleg).total, abs=1e-12)


def test_the_whole_is_pinocchios(hyperleg, rows):
    body = rigid_body_model(hyperleg)
    q = body.neutral()
    q[2] = 0
    data = body.model.createData()
    pin.ccrba(body.model, data, q, np.zeros(body.model.nv))
    row = rows["robot", "robot"]
    np.testing.assert_allclose(row.com, data.com[0], atol=1e-12)
    np.testing.assert_allclose(row.principal, np.linalg.eigvalsh(data.Ig.inertia), rtol=1e-12)


def test_a_leg_is_the_sum_of_its_segments_in_place(rows):
    places = {"thigh": 0.0, "shank": -0.37, "foot": -0.715, "toe": -0.715 - (0.071 - 0.024)}
    moment = sum(
        rows["segment", n].mass * (rows["segment", n].com[2] + z) for n, z in places.items()
    )
    assert rows["leg", "leg"].com[2] == pytest.approx(moment / 8.27, abs=1e-12)


def test_a_removed_toe_weighs_nothing(hyperleg):
    row = next(
        r
        for r in mass_rows(ablate(hyperleg, "toe_removed"))
        if (r.kind, r.name) == ("segment", "toe")
    )
    assert (row.mass, row.principal.tolist()) == (0.0, [0, 0, 0])
