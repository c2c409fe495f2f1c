"""Fits of causes that are linearised, against what they are linearised of."""

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference import screen
from hyperleg_design.gap.inference.hypothesis import Candidate
from hyperleg_design.gap.inference.hypothesis_fit import CLOSE, HypothesisFit
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
    return HypothesisFit(evidence, InferenceRules(), {}, {"payload": 2, "torque_constant": 2})


def fitted(fits, values):
    cause = screen.linearise(fits.evidence.tests, EFFECTS["payload"], PLACE, np.array(values))
    cause = fits.evidence.acting(cause, False)
    return fits.fit((Candidate("payload", PLACE, (cause,)),), fits.nothing.scales)


def test_a_load_is_the_same_wherever_it_was_linearised(fits):
    far, near = fitted(fits, [0.2, 0.02, 0.0, -0.35, 0.0]), fitted(fits, LOAD)
    assert abs(far.values(0)[0] - near.values(0)[0]) > 0.1 * LOAD[0]
    settled = fits.settled(far)
    np.testing.assert_allclose(settled.values(0)[0], fits.settled(near).values(0)[0], rtol=0.02)
    assert settled.values(0)[0] == pytest.approx(LOAD[0], rel=0.1)
    (cause,) = settled.causes
    assert (np.abs(cause.values - settled.values(0)) < CLOSE * cause.usual).all()


def test_what_is_linearised_where_it_is_stays_as_it_is(fits):
    settled = fits.settled(fitted(fits, LOAD))
    assert fits.settled(settled) is settled
