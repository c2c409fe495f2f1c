"""Columns of usual errors: the known ones first, then those that are the same in all sessions."""

import pytest

from hyperleg_design.gap.inference.log_set import log_set
from hyperleg_design.gap.inference.nuisance import nuisance_parameters
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.zeros import Zeros
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture(scope="module")
def standing(biped_runs):
    log = biped_runs["standing"]
    return condition(log, load_subject(None, [log]))


def test_gains_of_force_sensors_come_first_and_are_known(standing):
    subject, step = standing.subject, standing.step
    errors = nuisance_parameters(subject, step, calibrated=True)
    errors.sort(key=lambda error: (not error.known, not error.steady))
    logs = log_set(
        [standing], errors, Zeros.of([standing], [], subject), InferenceRules(), tested=True
    )
    own = [error.name for error in errors[: logs.known]]
    assert own == [f"contact_scale at {foot}" for foot in subject.feet]
    assert all(error.steady for error in errors[: logs.steady])
    assert not any(error.steady for error in errors[logs.steady :])
    assert len(logs.errors) == len(errors)
    row = logs.row(("base", 2))
    assert row is not None
    assert logs.samples.rows[row].name == "force_z"
    assert logs.row(("base", 9)) is None
