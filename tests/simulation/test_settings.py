from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.simulation.settings import Clock, Control, Limits, Physics, Thermal


def test_table_ii() -> None:
    physics = Physics()
    assert 1 / float(physics.time_step) == 200
    assert 1 / physics.policy_step == pytest.approx(50)
    assert Control().smoothing == 0.2
    assert Limits().duration == 20.0
    assert Thermal().time_constant == 3.0


@pytest.mark.parametrize(
    ("section", "field", "value"),
    [
        (Physics, "time_step", 0.0),
        (Physics, "cone", "round"),
        (Physics, "substeps", float("nan")),
        (Control, "smoothing", 1.5),
        (Clock, "stance", 1.0),
        (Limits, "tilt", "much"),
        (Thermal, "reading", "both"),
    ],
)
def test_bad_values_are_named(section: type, field: str, value: object) -> None:
    with pytest.raises(InputError, match=field):
        section(**{field: value})


def test_implicit_friction_at_the_motors_needs_its_integrator() -> None:
    with pytest.raises(InputError, match="integrator"):
        Physics(friction_space="motor")
    Physics(friction_space="motor", integrator="implicitfast")


def test_a_share_of_the_default_height_stands_in_place_of_the_height():
    assert Limits().of(0.9).height == 0.55
    assert Limits(height_share=0.5).of(0.9).height == pytest.approx(0.45)
    np.testing.assert_allclose(Limits(height_share=0.5).of([0.9, 0.3]).height, [0.45, 0.15])
