import dataclasses

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.inference.rules import InferenceRules, NoiseRules


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
                assert "[-]" in text or "[nat]" in text, line.target.id


def test_a_rule_that_is_no_number_is_refused():
    with pytest.raises(InputError, match="information"):
        InferenceRules(noise=NoiseRules(information=float("nan")))


def test_rules_change_one_at_a_time():
    rules = InferenceRules()
    other = dataclasses.replace(rules, noise=NoiseRules(information=0.5))
    assert other.noise.information == 0.5
    assert other.discrepancy == rules.discrepancy
