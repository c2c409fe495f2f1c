from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.prior_odds import MISSING, PER_PARAMETER, prior_odds


def cause(name, **changes):
    effect = EFFECTS[name]
    values = {
        "effect": name,
        "linear": effect.linear,
        "shape": np.array([p.shape for p in effect.parameters]),
        "low": np.array([p.low for p in effect.parameters]),
        "high": np.array([p.high for p in effect.parameters]),
        "usual": np.array([p.typical for p in effect.parameters]),
        "unseen": False,
        "declared": 0.0,
        "beyond": 0,
    }
    return SimpleNamespace(**{**values, **changes})


def test_each_free_parameter_costs_the_same():
    gains = cause("controller_gain")
    both = prior_odds(gains, np.array([0.8, 1.0]))
    one = prior_odds(
        cause("controller_gain", high=np.array([5.0, 1.0]), low=np.array([0.1, 1.0])),
        np.array([0.8, 1.0]),
    )
    assert one - both == pytest.approx(PER_PARAMETER)


def test_rare_effects_are_less_probable_and_those_whose_driver_nobody_logged_still_less():
    values = np.array([1.0, 0.0, 10.0])
    seen, unseen = (prior_odds(cause("voltage_sag", unseen=u), values) for u in (False, True))
    assert unseen - seen == EFFECTS["voltage_sag"].unseen < 0
    free = 3 * PER_PARAMETER
    assert seen == pytest.approx(EFFECTS["voltage_sag"].rare - free)


def test_friction_that_is_described_is_not_gone():
    described = cause("coulomb_friction", low=np.array([-2.0]))
    little, most = (prior_odds(described, np.array([v])) for v in (-0.5, -1.5))
    assert little - most == pytest.approx(MISSING)
    bare = cause("coulomb_friction", low=np.array([0.0]))
    assert prior_odds(bare, np.array([0.5])) == pytest.approx(little)
