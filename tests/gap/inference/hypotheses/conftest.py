"""Fits to logs whose residual is that of a load."""

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.hypotheses.hypothesis import Candidate
from hyperleg_design.gap.inference.hypotheses.hypothesis_fit import HypothesisFit
from hyperleg_design.gap.inference.linearisation import linearise
from hyperleg_design.gap.inference.rules import InferenceRules

PLACE = "shank"
LOAD = np.array([0.5, 0.0, 0.0, -0.2, 0.0])


@pytest.fixture(scope="module")
def fits(robot_files):
    """Of logs whose residual is that of a load, beside a healthy robot's."""
    found = diagnosed.evidence(
        robot_files["coupled"],
        diagnosed.run("healthy", 0),
        references=(diagnosed.run("healthy", 1, role="reference"),),
    )
    load = found.tests.columns(lambda s: EFFECTS["payload"].trace(s, PLACE, LOAD[None]), 1)[0]
    trace = np.zeros(len(found.samples.value))
    trace[: len(load)] = -load * found.weight[: len(load)]
    channels = tuple(one.without(trace) for one in found.channels)
    evidence = type(found)(**{**vars(found), "channels": channels})
    count = {"payload": 2, "load_dependent_friction": 2}
    return HypothesisFit(evidence, InferenceRules(), {}, count)


@pytest.fixture(scope="module")
def load():
    """Values of the load."""
    return LOAD


@pytest.fixture(scope="module")
def loaded():
    """Fit a load that is linearised at some values."""

    def fitted(fits, values):
        cause = linearise(fits.evidence.tests, EFFECTS["payload"], PLACE, np.array(values))
        cause = fits.evidence.on_all_samples(cause, False)
        return fits.fit((Candidate("payload", PLACE, (cause,)),), fits.null.scales)

    return fitted
