from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.equivalence import alike
from hyperleg_design.gap.inference.judge import Judge
from hyperleg_design.gap.inference.screen import linearise
from hyperleg_design.gap.inference.thresholds import load_thresholds


@pytest.fixture(scope="module")
def found(viscous_ready, knee_friction):
    judge = Judge(viscous_ready.base, load_thresholds(), 1)
    chosen = judge.model([knee_friction])
    return judge, chosen, judge.excess_rows(chosen)


def twin(model, effect):
    """The same predictions under another name."""
    return replace(model, causes=(replace(model.causes[0], effect=effect),))


def test_what_predicts_the_same_is_alike_and_the_cause_itself_is_no_rival(found):
    judge, chosen, rows = found
    rival = twin(chosen, "coulomb_friction")
    assert alike(judge, [chosen, rival], chosen, rows) == [rival]


def test_what_predicts_worse_is_not(found):
    judge, chosen, rows = found
    wrong = judge.model(
        [linearise(judge.base.samples, EFFECTS["coulomb_friction"], "hip", np.zeros(1))]
    )
    assert alike(judge, [wrong], chosen, rows) == []


def test_as_likely_but_closing_less_is_not(found):
    judge, chosen, rows = found
    short = replace(
        twin(chosen, "coulomb_friction"), held=replace(chosen.held, square=chosen.held.bare)
    )
    assert alike(judge, [short], chosen, rows) == []
