"""Imports go one way between the rooms of the package and of `gap`, and in no circle."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import hyperleg_design
from hyperleg_design.gap.effects import EFFECTS

PACKAGE = Path(hyperleg_design.__file__).parent
NAME = PACKAGE.name
ROOMS = (
    "robot",
    "sizing",
    "simulation",
    "learning",
    "evaluation",
    "gap",
    "validation",
    "sweep",
    "report",
    "cli",
)
"""Each room imports only rooms before it."""
WITHOUT_LEARNING = ("evaluation", "gap", "validation", "sweep")
GAP = (
    "results",
    "logs",
    "model",
    "signals",
    "effects",
    "checks",
    "inference",
    "playback",
    "experiments",
    "pipeline",
)
"""Rooms of `gap`, each of which imports only rooms before it."""
REPORT = ("pictures", "viewer", "sizing", "walks", "gap", "sweep", "study")
"""Rooms of `report`, each of which imports only rooms before it and what lies in no room."""


def module_name(path: Path) -> str:
    parts = (NAME, *path.relative_to(PACKAGE).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_name(path): path for path in sorted(PACKAGE.rglob("*.py"))}


@cache
def syntax(module: str) -> ast.Module:
    return ast.parse(MODULES[module].read_text())


def is_for_types(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)


@cache
def imports(module: str, *, types: bool) -> tuple[str, ...]:
    """Modules of the package that a module imports anywhere, functions included.

    Args:
        module: its dotted name.
        types: whether imports for annotations alone count.
    """
    return tuple(imported(module, types))


def imported(module: str, types: bool) -> Iterator[str]:
    package = module if MODULES[module].name == "__init__.py" else module.rpartition(".")[0]
    pending: list[ast.AST] = [syntax(module)]
    while pending:
        node = pending.pop()
        if is_for_types(node) and not types:
            pending.extend(node.orelse)
            continue
        if isinstance(node, ast.Import):
            yield from (a.name for a in node.names if a.name in MODULES)
        elif isinstance(node, ast.ImportFrom):
            above = package.rsplit(".", node.level - 1)[0] if node.level else ""
            source = ".".join(part for part in (above, node.module) if part)
            for alias in node.names:
                target = f"{source}.{alias.name}"
                if target in MODULES or source in MODULES:
                    yield target if target in MODULES else source
        pending.extend(ast.iter_child_nodes(node))


def room_of(module: str, depth: int) -> str | None:
    """Name of the package that a module lies in, `depth` levels below the top."""
    parts = module.split(".")
    return parts[depth] if len(parts) > depth else None


def circles(graph: dict[str, set[str]]) -> list[set[str]]:
    """Groups of more than one module that reach each other (Tarjan's algorithm)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    groups: list[set[str]] = []

    def visit(module: str) -> None:
        index[module] = low[module] = len(index)
        stack.append(module)
        for target in sorted(graph[module]):
            if target not in index:
                visit(target)
                low[module] = min(low[module], low[target])
            elif target in stack:
                low[module] = min(low[module], index[target])
        if low[module] == index[module]:
            group = set()
            while module not in group:
                group.add(stack.pop())
            if len(group) > 1:
                groups.append(group)

    for module in graph:
        if module not in index:
            visit(module)
    return groups


def test_rooms_of_the_package_import_only_rooms_before_them():
    wrong = [
        f"{module} imports {target}"
        for module in MODULES
        for target in imports(module, types=True)
        if (room := room_of(module, 1)) in ROOMS
        and (other := room_of(target, 1)) in ROOMS
        and (
            ROOMS.index(other) > ROOMS.index(room)
            or (room in WITHOUT_LEARNING and other == "learning")
        )
    ]
    assert not wrong, "\n".join(wrong)


def test_modules_in_no_room_import_none():
    wrong = [
        f"{module} imports {target}"
        for module, path in MODULES.items()
        if path.parent == PACKAGE and path.stem not in ("__init__", *ROOMS)
        for target in imports(module, types=True)
        if room_of(target, 1) in ROOMS
    ]
    assert not wrong, "\n".join(wrong)


def test_rooms_of_gap_import_only_rooms_before_them():
    assert {p.name for p in (PACKAGE / "gap").iterdir() if (p / "__init__.py").exists()} == set(GAP)
    wrong = [
        f"{module} imports {target}"
        for module in MODULES
        if module.startswith(f"{NAME}.gap.")
        for target in imports(module, types=True)
        if target.startswith(f"{NAME}.gap.")
        and GAP.index(target.split(".")[2]) > GAP.index(module.split(".")[2])
    ]
    assert not wrong, "\n".join(wrong)


def test_rooms_of_report_import_only_rooms_before_them():
    order = {room: place for place, room in enumerate(REPORT, 1)}
    wrong = [
        f"{module} imports {target}"
        for module in MODULES
        if module.startswith(f"{NAME}.report.")
        for target in imports(module, types=True)
        if target.startswith(f"{NAME}.report.")
        and order.get(target.split(".")[2], 0) > order.get(module.split(".")[2], 0)
    ]
    assert not wrong, "\n".join(wrong)


def test_modules_of_gap_lie_in_rooms():
    assert [p.name for p in (PACKAGE / "gap").glob("*.py")] == ["__init__.py"]


@pytest.mark.parametrize("types", [False, True])
def test_no_imports_run_in_a_circle(types):
    """At run time nowhere; for annotations not within `gap`, `validation` and `report`."""
    rooms = ("gap", "validation", "report")
    graph = {
        module: {t for t in imports(module, types=types) if t != module}
        for module in MODULES
        if not types or room_of(module, 1) in rooms
    }
    found = circles({m: targets & graph.keys() for m, targets in graph.items()})
    assert not found, found


def test_circles_are_seen():
    graph = {"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": {"e"}, "e": set()}
    assert circles(graph) == [{"a", "b", "c"}]


ALSO_FIELDS = {"payload", "torque_constant"}
"""Names of effects that are fields of metadata and of motors as well."""


def test_no_name_of_an_effect_stands_outside_the_effects():
    """What is known of an effect is a field or a method of it; plants, cases and truths of the
    validation speak of effects by name, of course.
    """
    for module, path in MODULES.items():
        place = path.relative_to(PACKAGE).as_posix()
        if not place.startswith(("gap/", "report/gap/")) or place.startswith("gap/effects/"):
            continue
        constants = [n.value for n in ast.walk(syntax(module)) if isinstance(n, ast.Constant)]
        names = [value for value in constants if isinstance(value, str) and value in EFFECTS]
        assert set(names) <= ALSO_FIELDS, f"{place}: {', '.join(names)}"
