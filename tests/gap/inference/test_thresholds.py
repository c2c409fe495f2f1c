import dataclasses

import pytest
import yaml

from hyperleg_design.errors import InputError
from hyperleg_design.gap.inference.thresholds import load_thresholds


def test_the_shipped_rules_are_whole():
    rules = load_thresholds()
    assert all(v >= 0 for v in dataclasses.asdict(rules).values())
    assert rules.most_certain < 1


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("evident", "much"),
        ("evident", None),
        ("evident", float("nan")),
        ("worth", -0.1),
        ("evident", True),
    ],
)
def test_a_rule_that_is_no_number_is_refused(tmp_path, name, value):
    content = dataclasses.asdict(load_thresholds()) | {name: value}
    path = tmp_path / "rules.yaml"
    path.write_text(yaml.safe_dump(content))
    with pytest.raises(InputError, match=name):
        load_thresholds(path)


def test_unknown_and_missing_rules_are_refused(tmp_path):
    content = dataclasses.asdict(load_thresholds())
    path = tmp_path / "rules.yaml"
    path.write_text(yaml.safe_dump(content | {"luck": 1.0}))
    with pytest.raises(InputError, match="luck"):
        load_thresholds(path)
    content.pop("worth")
    path.write_text(yaml.safe_dump(content))
    with pytest.raises(InputError, match="worth"):
        load_thresholds(path)
