from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import pytest

from hyperleg_design.report.page import (
    Cell,
    Details,
    Missing,
    Page,
    Picture,
    Section,
    Table,
    number,
    render,
)


def test_numbers_are_short_and_keep_their_size():
    assert number(32.0) == "32"
    assert number(0.12345678) == "0.1235"
    assert number(123456.0) == "1.235e+05"
    assert number(1e-5) == "1.000e-05"
    assert number(0.0) == "0"
    assert number(float("nan")) == "–"
    assert number(True) == "yes"
    assert number(14) == "14"


def test_page_holds_its_content_and_escapes_texts():
    content = [
        "a < b & c",
        Table(["x [m]", "y"], [[1.5, Cell("bad & worse", "bad")]], "caption"),
        [Picture("f/a.png", "one"), Picture("f/b.png", "two")],
        Missing("figure", "no screen"),
        Details("more", [Table(["z"], [[1]])]),
    ]
    html = render(
        Page("Title <1>", "lead", [Section("Part", content)], [("3 kg", "mass")], {"numpy": "2"})
    )
    assert "a &lt; b &amp; c" in html
    assert "Title &lt;1&gt;" in html
    assert 'src="f/a.png"' in html
    assert '<td class="bad short">bad &amp; worse</td>' in html
    assert "no screen" in html
    assert html.count("<table>") == 2


def test_page_is_well_formed():
    html = render(Page("T", "l", [Section("S", ["p", Table(["a"], [[1.0]])])]))
    body = html[html.index("<main>") : html.index("</main>") + 7]
    ElementTree.fromstring(body)


@pytest.mark.parametrize("value", [1234.5, 99999.0, 0.001])
def test_number_round_trips_to_its_digits(value):
    assert float(number(value)) == pytest.approx(value, rel=5e-4)
