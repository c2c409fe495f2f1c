"""YAML and JSON files as users write them, read strictly."""

from __future__ import annotations

import copy
import inspect
import json
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from hyperleg_design import resources
from hyperleg_design.errors import InputError, in_short

MAX_DEPTH = 50
"""Levels of nesting that a file may have."""
_BASE: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_yaml(path: Path) -> dict[str, Any]:
    """Read a YAML file that holds a mapping.

    Args:
        path: of the file.

    Returns:
        The mapping, with plain Python values.

    Raises:
        InputError: unreadable, malformed (with line), duplicate keys, or no mapping.
    """
    text = ""
    try:
        text = path.read_text(encoding="utf-8")
        data = parse_yaml(text)
    except OSError as error:
        raise InputError(given_path(path), "", None, f"cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise InputError(given_path(path), "", None, "is not a text file in UTF-8") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = f", line {mark.line + 1}" if mark else ""
        problem = " ".join(str(getattr(error, "problem", None) or error).split())
        if mark and "\t" in text[mark.index : mark.index + 1]:
            problem = "a tab stands where spaces must; indent with spaces"
        raise InputError(
            f"{given_path(path)}{place}", "", None, f"is not YAML: {problem}"
        ) from None
    if not isinstance(data, dict):
        raise InputError(given_path(path), "", data, "expects a mapping of sections")
    return data


def read_json(path: Path, where: str = "") -> Any:
    """Read a JSON file.

    Args:
        path: of the file.
        where: what errors call it; its path as it was given by default.

    Returns:
        Its content.

    Raises:
        InputError: unreadable, or no JSON.
    """
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(
            where or given_path(path), "", None, f"cannot be read ({error.strerror})"
        ) from None
    except (ValueError, RecursionError) as error:
        raise InputError(
            where or given_path(path), "", None, f"is not JSON ({in_short(error, 80)})"
        ) from None


def parse_yaml(text: str) -> Any:
    """Parse a YAML text.

    Args:
        text: the text.

    Returns:
        Its content, with plain Python values.

    Raises:
        yaml.YAMLError: malformed, a key twice, or a value that its own type forbids (a 13th month).
    """
    return copy.deepcopy(_parsed(text))


@lru_cache(maxsize=256)  # every design reads its base's file again
def _parsed(text: str) -> Any:
    depth = 0
    for event in yaml.parse(
        text, Loader=_BASE
    ):  # PyYAML's C code crashes the process on very deep nesting
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(
            event, yaml.CollectionEndEvent
        )
        if depth > MAX_DEPTH:
            raise yaml.MarkedYAMLError(
                problem=f"nested more than {MAX_DEPTH} deep",
                problem_mark=event.start_mark,  # type: ignore[arg-type]
            )
    return yaml.load(text, Loader=_Loader)


class _Loader(_BASE):  # type: ignore[misc]
    """Safe YAML that refuses a key twice, and numbers in base 60."""

    def construct_mapping(self, node: Any, deep: bool = False) -> Any:
        if isinstance(node, yaml.MappingNode):
            seen = set()
            for key, _ in node.value:
                if not isinstance(key, yaml.ScalarNode):
                    raise yaml.constructor.ConstructorError(
                        None, None, "a key must be a plain word", key.start_mark
                    )
                if key.value in seen:
                    raise yaml.constructor.ConstructorError(
                        None, None, f"{key.value} stands twice", key.start_mark
                    )
                seen.add(key.value)
        return super().construct_mapping(node, deep)

    def construct_object(self, node: Any, deep: bool = False) -> Any:
        if node.tag.endswith((":int", ":float")) and ":" in node.value:
            problem = f"{node.value!r:.60} is no number; write ratios such as 1:6 as one number"
            raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark)
        try:
            return super().construct_object(node, deep)
        except (ValueError, OverflowError, AttributeError, KeyError, TypeError) as error:
            # PyYAML lets through what Python's own types say: 2020-13-01, !!int x
            raise yaml.constructor.ConstructorError(
                None, None, f"{node.value!r:.60} is no value ({error})", node.start_mark
            ) from None


def given_path(path: Path) -> str:
    """Name a file in messages as its user gave it.

    Args:
        path: of the file.

    Returns:
        The path as it stands; of a shipped file, which users name without a path, folder and name.
    """
    if path.is_absolute():
        for kind in resources.CONTENT:
            if path.is_relative_to(resources.content_folder(kind)):
                return short_name(path)
    return str(path)


def short_name(path: Path) -> str:
    """Name a file by its folder and name, for results that do not depend on where it lay.

    Args:
        path: of the file.

    Returns:
        The short name.
    """
    return f"{path.parent.name}/{path.name}" if path.parent.name else path.name or str(path)


def summary_line(documented: object) -> str:
    """Write the first paragraph of an object's docstring as one line, however the source wraps it.

    Args:
        documented: the object.

    Returns:
        The line; empty without a docstring.
    """
    return " ".join((inspect.getdoc(documented) or "").split("\n\n")[0].split())
