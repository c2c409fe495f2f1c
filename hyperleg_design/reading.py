"""YAML files as users write them, read strictly."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from hyperleg_design.errors import InputError


def read_yaml(path: Path) -> dict[str, Any]:
    """A YAML mapping.

    Raises:
        InputError: unreadable, malformed (with line), duplicate keys, or no mapping.
    """
    try:
        data = yaml.load(path.read_text(encoding="utf-8"), Loader=_Loader)
    except OSError as error:
        raise InputError(short_name(path), "", None, f"cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise InputError(short_name(path), "", None, "is not a text file in UTF-8") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = f", line {mark.line + 1}" if mark else ""
        raise InputError(f"{short_name(path)}{place}", "", None, f"is not YAML: {getattr(error, 'problem', error)}") from None
    if not isinstance(data, dict):
        raise InputError(short_name(path), "", data, "expects a mapping of sections")
    return data


class _Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """Safe YAML that refuses a key twice."""

    def construct_mapping(self, node: Any, deep: bool = False) -> Any:
        seen = set()
        for key, _ in node.value:
            if key.value in seen:
                raise yaml.constructor.ConstructorError(None, None, f"{key.value} stands twice", key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep)


def short_name(path: Path) -> str:
    """Folder and name of a file, for messages."""
    return f"{path.parent.name}/{path.name}" if path.parent.name else path.name
