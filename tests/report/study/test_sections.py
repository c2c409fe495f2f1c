"""Parts of the study whose words depend on numbers."""

from __future__ import annotations

import pytest

from hyperleg_design.report.drawer import FIGURES
from hyperleg_design.report.page import Details, Table
from hyperleg_design.report.study import sections as study_sections
from hyperleg_design.report.study.context import Context
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.design import Design, load_design
from hyperleg_design.robot.parameters import values as parameters


@pytest.fixture
def context(tmp_path):
    (tmp_path / FIGURES).mkdir()
    design = load_design("hyperleg")
    return Context(design, variants(design), tmp_path)


def test_table_one_counts_what_agrees(context):
    made = study_sections.table_i(context)
    assert made.facts[0][0] == "18 / 25"


def test_a_changed_robot_agrees_less(context):
    changed = Context(
        context.design.with_values({"toe.mass": 0.4}), context.variants, context.folder
    )
    assert study_sections.table_i(changed).facts[0][0] == "16 / 25"


def test_every_parameter_is_on_the_page_with_its_label(context):
    made = study_sections.made_from(context)
    details = next(c for c in made.section.content if isinstance(c, Details))
    table = next(c for c in details.content if isinstance(c, Table))
    assert {row[0] for row in table.rows} == set(parameters.rules(Design))
    assert all(row[3] in parameters.LABELS for row in table.rows)


def test_the_catalogue_names_what_is_assumed(context):
    made = study_sections.motors(context)
    table = next(c for c in made.section.content if isinstance(c, Table))
    row = next(r for r in table.rows if r[0] == "U10")
    assert "rotor" in row[-1].value
    assert len(table.rows) >= 11
