from __future__ import annotations

from hyperleg_design.report.evaluation_text import evaluation_text


def test_what_could_not_be_measured_stays_empty():
    rows = [
        {
            "variant": "toe",
            "protocol": "walk",
            "measure": "power",
            "unit": "W",
            "mean": 250.5,
            "low": None,
            "high": None,
            "seeds": 1,
            "trials": 10,
            "missing": 2,
        },
        {
            "variant": "toe",
            "protocol": "walk",
            "measure": "cadence",
            "unit": "Hz",
            "mean": None,
            "low": None,
            "high": None,
            "seeds": 0,
            "trials": 0,
            "missing": 10,
        },
    ]
    lines = evaluation_text(rows).splitlines()
    assert "250.5" in lines[2]
    assert "None" not in "".join(lines)
    assert lines[3].split() == ["toe", "cadence", "Hz", "0", "0", "10"]
