from __future__ import annotations

from hyperleg_design.report.evaluation_text import evaluation_text


def test_what_no_trial_has_is_named_below_the_table():
    common = {
        "variant": "toe",
        "trained": "specialist",
        "protocol": "walk",
        "low": None,
        "high": None,
    }
    rows = [
        {
            **common,
            "measure": "power",
            "unit": "W",
            "mean": 250.5,
            "seeds": 1,
            "trials": 10,
            "missing": 2,
        },
        {
            **common,
            "measure": "cadence",
            "unit": "Hz",
            "mean": None,
            "seeds": 0,
            "trials": 0,
            "missing": 10,
        },
    ]
    lines = evaluation_text(rows).splitlines()
    assert "250.5" in lines[2]
    assert "None" not in "".join(lines)
    assert lines[3:] == ["without a value in any trial: cadence"]
