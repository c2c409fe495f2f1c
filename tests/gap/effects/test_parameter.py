"""Values of parameters lie inside their bounds."""

from __future__ import annotations

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects.parameter import Parameter


def test_values_outside_the_bounds_are_refused_with_bounds_and_unit():
    torque = Parameter("torque", "Nm", 0.0, -5.0, 10.0, 0.1, "made up")
    for value in (-5.0, 0.0, 10.0):
        assert torque.checked(value, "overlay.yaml", "gap.torque") == value
    for value in (-5.1, 10.1, float("nan"), float("inf")):
        with pytest.raises(InputError, match=r"overlay.yaml.*torque.*expects -5 .. 10 Nm"):
            torque.checked(value, "overlay.yaml", "gap.torque")
