"""HTML pages: sections of text, tables and figures, in one self-contained folder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

TEMPLATES = Path(__file__).parent / "templates"


@dataclass(frozen=True)
class Table:
    """A table; cells are texts or numbers, a cell may be a `Cell` with a class."""

    headers: Sequence[str]
    rows: Sequence[Sequence[Any]]
    caption: str = ""


@dataclass(frozen=True)
class Cell:
    """A table cell with a mark: `good`, `bad` or `note`."""

    value: Any
    mark: str = ""


@dataclass(frozen=True)
class Picture:
    """A figure of the page's folder."""

    file: str
    """Path relative to the page."""
    caption: str
    wide: bool = True
    chart: bool = False
    """Whether it is lines on white, which a dark scheme may show inverted."""


@dataclass(frozen=True)
class Missing:
    """A figure that could not be made, and why."""

    caption: str
    reason: str


@dataclass(frozen=True)
class Details:
    """Content that opens on a click."""

    summary: str
    content: Sequence[Any]
    unfolded: bool = False
    """Whether it is open at first."""


@dataclass(frozen=True)
class Commands:
    """Command lines to copy into a terminal."""

    lines: Sequence[str]


@dataclass(frozen=True)
class Explorer:
    """Points that a reader sorts, filters and selects; `templates/explorer.js` shows them."""

    name: str
    """Unique in the page."""
    data: dict[str, Any]
    """As `report.sweep.explorer` makes it."""


@dataclass(frozen=True)
class Heading:
    """A heading inside a section."""

    text: str


@dataclass(frozen=True)
class Section:
    """A part of a page under a heading of its own."""

    title: str
    content: Sequence[Any] = ()
    """Texts (paragraphs), `Heading`, `Table`, `Picture`, `Missing`, `Details`, `Commands`; a list
    of pictures stands side by side."""
    anchor: str = ""


@dataclass(frozen=True)
class Page:
    """A whole page: title, sections, headline numbers and provenance."""

    title: str
    lead: str
    sections: Sequence[Section]
    facts: Sequence[tuple[str, str]] = ()
    """Headline numbers: value and what it is."""
    provenance: dict[str, Any] = field(default_factory=dict)


def number(value: Any, digits: int = 4) -> str:
    """Write a number with a few significant digits, for a table.

    Args:
        value: a number, text, true, false or None.
        digits: significant digits.

    Returns:
        The text.
    """
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return {True: "yes", False: "no", None: ""}.get(value, str(value))  # type: ignore[arg-type]
    if isinstance(value, int):
        return str(value)
    if value != value:
        return "–"
    if value == 0:
        return "0"
    if 1e-3 <= abs(value) < 1e5:
        text = f"{value:.{digits}g}"
        return f"{float(text):.10g}" if "e" in text else text
    return f"{value:.{digits - 1}e}"


def render(page: Page) -> str:
    """Write a page as HTML; plotly is embedded, once, where an explorer needs it.

    Args:
        page: the page.

    Returns:
        The HTML.
    """
    explored = any(isinstance(item, Explorer) for s in page.sections for item in s.content)
    names = ("plotly-basic.min.js", "explorer.js") if explored else ()
    scripts = [(TEMPLATES / name).read_text(encoding="utf-8") for name in names]
    return fill("page.html", page=page, scripts=scripts)


def fill(template: str, **values: Any) -> str:
    """Fill one of the templates beside this file.

    Args:
        template: name of the file.
        values: that the template uses.

    Returns:
        The text.
    """
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = number
    environment.tests["kind"] = lambda value, name: type(value).__name__ == name
    return environment.get_template(template).render(**values)
