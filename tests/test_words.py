"""Public docstrings are sentences, and names of variables say what they hold.

What still breaks these rules is counted by package, and the counts may only fall.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import hyperleg_design

PACKAGE = Path(hyperleg_design.__file__).parent
BARRED = {"found", "told", "one", "kept", "made", "says"}
"""Names that do not say what a variable holds."""
FEWEST_WORDS = 3
"""Words that the first paragraph of a public docstring has at least."""
NAMES_ALLOWED = {
    "evaluation": 5,
}
"""Bindings of barred names that are left, by package; lower a number when you rename some."""
DOCSTRINGS_ALLOWED = {"gap": 1}
"""Public docstrings that are too short, by package; lower a number when you mend some."""

ARGUMENTS_ALLOWED: dict[str, int] = {}
"""Public functions whose docstrings do not describe every argument, by package; lower a number when
you mend some. What a decorator registers under one signature (reward terms, observations, measures)
is described once, in its module."""
PLAIN_DECORATORS = {"cached_property", "classmethod", "contextmanager", "cache", "staticmethod"}
"""Decorators that do not register a function."""


def package_of(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0]


@cache
def modules() -> dict[Path, tuple[ast.AST, ...]]:
    """All nodes of the syntax of each module."""
    paths = sorted(PACKAGE.rglob("*.py"))
    return {path: tuple(ast.walk(ast.parse(path.read_text()))) for path in paths}


def bound_names(nodes: Iterable[ast.AST]) -> Iterator[str]:
    for node in nodes:
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.arg):
            yield node.arg
        elif isinstance(node, ast.FunctionDef):
            yield node.name


def short_docstrings(nodes: Iterable[ast.AST]) -> Iterator[str]:
    for node in nodes:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            text = ast.get_docstring(node)
            if text and len(text.split("\n\n")[0].split()) < FEWEST_WORDS:
                yield node.name


def described(node: ast.FunctionDef) -> set[str]:
    """Names of the arguments that a docstring describes under `Args`."""
    text = (ast.get_docstring(node) or "").partition("Args:\n")[2]
    section = re.split(r"\n(?:Returns|Raises|Yields):", text)[0]
    lines = re.findall(r"^    ([\w, ]+):", section, flags=re.MULTILINE)
    return {name.strip() for line in lines for name in line.split(",")}


def undescribed(nodes: Iterable[ast.AST]) -> Iterator[str]:
    """Public functions with arguments that their docstrings do not describe under `Args`; methods
    of private classes are not public.
    """
    nodes = tuple(nodes)
    private = {
        method
        for node in nodes
        if isinstance(node, ast.ClassDef) and node.name.startswith("_")
        for method in node.body
    }
    for node in nodes:
        if not isinstance(node, ast.FunctionDef) or node.name.startswith("_") or node in private:
            continue
        decorators = {ast.unparse(one).split("(")[0].split(".")[-1] for one in node.decorator_list}
        every = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
        every += [one for one in (node.args.vararg, node.args.kwarg) if one]
        names = [one.arg for one in every if one.arg not in ("self", "cls")]
        text = ast.get_docstring(node)
        if text and decorators <= PLAIN_DECORATORS and not set(names) <= described(node):
            yield node.name


def test_docstrings_describe_no_argument_that_is_not_there():
    for path, nodes in modules().items():
        for node in nodes:
            if isinstance(node, ast.FunctionDef):
                names = {one.arg for one in ast.walk(node.args) if isinstance(one, ast.arg)}
                assert described(node) <= names, f"{path.name}: {node.name}"


def test_barred_names_become_fewer():
    counts = Counter(
        package_of(path)
        for path, nodes in modules().items()
        for name in bound_names(nodes)
        if name in BARRED
    )
    more = {p: n for p, n in counts.items() if n > NAMES_ALLOWED.get(p, 0)}
    assert not more, f"name the variables after what they hold: {more}"


def test_public_docstrings_are_sentences():
    short: dict[str, list[str]] = {}
    for path, nodes in modules().items():
        names = [f"{path.stem}.{name}" for name in short_docstrings(nodes)]
        short[package_of(path)] = short.get(package_of(path), []) + names
    more = {p: names for p, names in short.items() if len(names) > DOCSTRINGS_ALLOWED.get(p, 0)}
    assert not more, f"say what these compute: {more}"


def test_public_docstrings_describe_their_arguments():
    missing: dict[str, list[str]] = {}
    for path, nodes in modules().items():
        names = [f"{path.stem}.{name}" for name in undescribed(nodes)]
        missing[package_of(path)] = missing.get(package_of(path), []) + names
    more = {p: n for p, n in missing.items() if len(n) > ARGUMENTS_ALLOWED.get(p, 0)}
    assert not more, f"describe the arguments of these: {more}"


def test_all_kinds_are_seen():
    nodes = list(ast.walk(ast.parse('def mass(found):\n    """[kg]"""\n    told = found\n')))
    assert BARRED & set(bound_names(nodes)) == {"found", "told"}
    assert list(short_docstrings(nodes)) == ["mass"]
    assert list(undescribed(nodes)) == ["mass"]
