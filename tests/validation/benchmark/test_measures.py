"""The counting of the table."""

from __future__ import annotations

from hyperleg_design.validation.benchmark.measures import case_table, measures, table


def row(name, outcome, kind="single", split="development", suite="real", **more):
    score = {
        "outcome": outcome,
        "confident_wrong": False,
        "untrue_beside": None,
        "all_named": None,
        "inside": None,
        "probability": None,
        "remainder": None,
        "closed": None,
        "said": outcome,
    }
    truth = {"references": True, "identified": True, "visible": None, "text": kind}
    truth |= {k: more.pop(k) for k in list(more) if k in truth}
    return {
        "name": name,
        "suite": suite,
        "split": split,
        "kind": kind,
        "truth": truth,
        "seconds": 2.0,
        "score": score | more,
    }


ROWS = [
    row("a", "right", inside=True, untrue_beside=False),
    row("b", "equivalent", untrue_beside=True),
    row("c", "wrong", probability=0.95, split="held out", confident_wrong=True),
    row("d", "unknown, led", split="held out"),
    row("e", "right", "nothing"),
    row("f", "false cause", "nothing", confident_wrong=True),
    row("g", "remainder", "nothing", references=False),
    row("h", "unknown", "nothing", references=False, identified=False),
    row("i", "right", "everywhere", suite="newcomers", all_named=False),
    row("j", "right", "single", suite="blind", visible=False),
]


def test_each_measure_counts_its_own_cases():
    found = {m.name: (m.hits, m.of) for m in measures(ROWS)}
    assert found["real, faults: right or honest equivalent, first"] == (2, 4)
    assert found["real, right or equivalent: no untrue cause beside"] == (1, 2)
    assert found["real, nothing wrong, references: `none`"] == (1, 2)
    bare = "real, nothing wrong, identified model, no references: `none` or a bare remainder"
    assert found[bare] == (1, 1)
    assert found["real, faults: confident wrong cause"] == (1, 4)
    assert found["real, nothing wrong: confident wrong cause"] == (1, 4)
    assert found["... as probable, `ambiguous` answers included"] == (1, 4)
    assert found["real, right: the value inside its 95 % interval"] == (1, 1)
    assert found["newcomers, one effect at several joints: all named"] == (0, 1)
    assert "blind, one effect at 2 x floor or more: right, first" not in found


def test_the_table_parts_development_from_held_out_and_every_case_has_a_line():
    text = table(ROWS)
    line = next(x for x in text.splitlines() if x.startswith("| real, faults: right or honest"))
    assert "| 2 of 2 | 0 of 2 | 2 of 4 |" in line
    assert "15% .. 85%" in line
    assert case_table(ROWS).count("\n") == 2 + len(ROWS)
