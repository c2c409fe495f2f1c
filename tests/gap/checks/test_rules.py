"""The numbers of the checks are finite, and each says its unit and where it comes from."""

from __future__ import annotations

import ast
import dataclasses
import math
import re
from pathlib import Path

from hyperleg_design.gap.checks import rules

LABELS = ("derived", "assumed")


def test_all_numbers_are_finite():
    for section in dataclasses.fields(rules.RULES):
        for value in dataclasses.asdict(getattr(rules.RULES, section.name)).values():
            assert math.isfinite(value)


def test_every_number_says_its_unit_and_its_origin():
    tree = ast.parse(Path(rules.__file__).read_text())
    sections = [n for n in tree.body if isinstance(n, ast.ClassDef) and n.name != "CheckRules"]
    count = 0
    for section in sections:
        for number, told in zip(section.body[1::2], section.body[2::2], strict=True):
            assert isinstance(number, ast.AnnAssign)
            text = ast.literal_eval(told.value)
            assert re.search(r"\[[^\]]+\]", text), ast.unparse(number)
            assert any(label in text for label in LABELS), ast.unparse(number)
            count += 1
    assert count == sum(
        len(dataclasses.fields(getattr(rules.RULES, f.name)))
        for f in dataclasses.fields(rules.RULES)
    )
