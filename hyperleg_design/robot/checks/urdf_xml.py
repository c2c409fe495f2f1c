"""Elements of a URDF: parsing, what to call them, and their numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.checks.finding import Finding


def parse_xml(
    source: str | Path, root: str | None = None, remedy: str = ""
) -> tuple[Any, list[Finding]]:
    """Parse an XML file or text.

    Args:
        source: path of the file, or the text itself, which begins with `<`.
        root: tag that the root element must have; None for any.
        remedy: what to do about another root element, for the finding.

    Returns:
        The root element and no findings, or None and the error of its syntax or of its root.

    Raises:
        InputError: the file cannot be read.
    """
    from lxml import etree  # type: ignore[import-untyped]

    if isinstance(source, str) and source.lstrip().startswith("<"):
        content = source.encode()
    else:
        path = Path(source)
        try:
            content = path.read_bytes()
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise InputError(
                str(path), "", None, f"cannot be read ({reason}); give the path of a file"
            ) from None
    try:
        parser = etree.XMLParser(
            resolve_entities=False, no_network=True, remove_comments=True, remove_pis=True
        )
        element = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        return None, [
            Finding(
                "error",
                f"line {error.lineno or 1}",
                f"is not XML: {error.msg}",
                "close and quote every element there",
            )
        ]
    if root is not None and element.tag != root:
        line, tag = element.sourceline, element.tag
        return None, [Finding("error", f"line {line}", f"the root element is <{tag}>", remedy)]
    return element, []


def place_of(element: Any) -> str:
    """Name an element for findings.

    Args:
        element: of the URDF.

    Returns:
        Its tag, name and line.
    """
    return f"{element.tag} {element.get('name') or '(no name)'} (line {element.sourceline})"


def ends_of(joint: Any) -> tuple[str | None, str | None]:
    """Look up the links that a joint connects.

    Args:
        joint: the element.

    Returns:
        Names of parent and child; None where one is missing.
    """
    parent, child = joint.find("parent"), joint.find("child")
    return (None if parent is None else parent.get("link")), (
        None if child is None else child.get("link")
    )


def numbers(text: str | None, count: int) -> np.ndarray | None:
    """Parse the numbers of an attribute.

    Args:
        text: of the attribute; None where it is missing.
        count: how many numbers are expected.

    Returns:
        `(count,)`; None if there are more or fewer, or one is not finite.
    """
    try:
        values = np.array([float(v) for v in (text or "").split()])
    except ValueError:
        return None
    return values if len(values) == count and np.all(np.isfinite(values)) else None


def check_origin(element: Any, place: str) -> list[Finding]:
    """Check the origin of an element.

    Args:
        element: that may hold an `<origin>`.
        place: of the element, for findings.

    Returns:
        What is wrong with its numbers.
    """
    origin = element.find("origin")
    if origin is None:
        return []
    bad = [
        key
        for key in ("xyz", "rpy")
        if origin.get(key) is not None and numbers(origin.get(key), 3) is None
    ]
    return [
        Finding("error", place, f"origin has {key}={origin.get(key)!r}", "expects three numbers")
        for key in bad
    ]
