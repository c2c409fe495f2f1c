"""The package as a whole: what an import costs, and that everything says what it is."""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import hyperleg_design

PACKAGE = Path(hyperleg_design.__file__).parent
MODULES = sorted(PACKAGE.rglob("*.py"))
HEAVY = (
    "mujoco",
    "pinocchio",
    "cvxpy",
    "pandas",
    "pyvista",
    "matplotlib",
    "scipy",
    "torch",
    "xacro",
    "yourdfpy",
    "lxml",
)


def name_of(path: Path) -> str:
    return str(path.relative_to(PACKAGE))


@pytest.mark.parametrize(
    "statement", ["import hyperleg_design", "import hyperleg_design; hyperleg_design.load_design()"]
)
def test_heavy_libraries_load_when_used(statement):
    code = f"import sys; {statement}; print(*sorted(set({HEAVY!r}) & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_every_public_name_resolves():
    for name in hyperleg_design.__all__:
        assert getattr(hyperleg_design, name) is not None
    assert set(hyperleg_design.__all__) == set(dir(hyperleg_design))
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = hyperleg_design.no_such_name


def test_public_names_are_the_same_to_a_type_checker():
    tree = ast.parse((PACKAGE / "__init__.py").read_text())
    guarded = next(node for node in tree.body if isinstance(node, ast.If))
    typed = {
        (a.asname, node.module)
        for node in guarded.body
        if isinstance(node, ast.ImportFrom)
        for a in node.names
    }
    assert typed == {
        (name, f"hyperleg_design.{home}") for name, home in hyperleg_design._HOME.items()
    }


PUBLIC = [name for name in hyperleg_design.__all__ if callable(getattr(hyperleg_design, name))]


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_docstring_names_arguments_and_result(name):
    value = getattr(hyperleg_design, name)
    text = inspect.getdoc(value) or ""
    first = text.split("\n\n")[0].strip()
    assert len(first.split()) >= 3, "says too little"
    assert first.endswith((".", ":")) or "." in first, "is no sentence"
    if inspect.isclass(value):
        return
    signature = inspect.signature(value)
    if signature.parameters:
        assert "Args:" in text
    for parameter in signature.parameters:
        assert f"\n    {parameter}: " in text, f"does not say what {parameter} is"
    assert "Returns:" in text
    assert signature.return_annotation is not inspect.Signature.empty


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_every_module_says_what_it_holds(path):
    assert ast.get_docstring(ast.parse(path.read_text()))


def test_library_code_prints_nothing():
    for path in MODULES:
        if path.parent.name == "cli":
            continue
        calls = (
            n
            for n in ast.walk(ast.parse(path.read_text()))
            if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)
        )
        assert not [n.lineno for n in calls if n.func.id == "print"], name_of(path)
