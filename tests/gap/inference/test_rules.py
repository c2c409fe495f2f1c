import dataclasses
import re

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.inference.rules import CauseRules, InferenceRules, NoiseRules


def test_every_rule_is_documented_with_its_unit():
    import ast
    import inspect

    from hyperleg_design.gap.inference import rules

    tree = ast.parse(inspect.getsource(rules))
    for one in tree.body:
        if not isinstance(one, ast.ClassDef) or one.name == "InferenceRules":
            continue
        for place, line in enumerate(one.body):
            if isinstance(line, ast.AnnAssign):
                after = one.body[place + 1]
                assert isinstance(after, ast.Expr), line.target.id
                text = " ".join(after.value.value.split())
                assert re.search(r"\[(-|nat|s|m|rad|N|m/s|rad/s|Hz)\]", text), line.target.id


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -0.1])
def test_a_rule_that_is_no_number_is_refused(value):
    with pytest.raises(InputError, match=r"noise\.information.*expects a finite number, 0 or more"):
        InferenceRules(noise=NoiseRules(information=value))


def test_what_is_certain_beforehand_is_no_prior_probability():
    with pytest.raises(InputError, match=r"cause\.probability = 1\.0: expects .* below 1"):
        InferenceRules(cause=CauseRules(probability=1.0))


def test_rules_change_one_at_a_time():
    rules = InferenceRules()
    other = dataclasses.replace(rules, noise=NoiseRules(information=0.5))
    assert other.noise.information == 0.5
    assert other.discrepancy == rules.discrepancy
