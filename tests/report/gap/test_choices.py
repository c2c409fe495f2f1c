from __future__ import annotations

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.report.gap.choices import chosen


def test_a_choice_has_its_words_and_a_size_has_none() -> None:
    for effect in EFFECTS.values():
        values = {p.name: {"value": float(len(p.choices) - 1)} for p in effect.parameters}
        rows = chosen(effect.identifier, values)
        assert [name for name, _, _ in rows] == [p.name for p in effect.parameters]
        expected = [p.choices[-1] if p.choices else "" for p in effect.parameters]
        assert [words for _, _, words in rows] == expected
