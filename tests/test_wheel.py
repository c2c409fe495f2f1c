"""The wheel: small, complete, and usable in a clean environment away from the checkout."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

import hyperleg_design

CHECKOUT = Path(hyperleg_design.__file__).resolve().parent.parent
LARGEST = 20e6
"""Size that a wheel may have [byte]."""

pytestmark = pytest.mark.slow


def run(*command: str | Path, **environment: str) -> str:
    kept = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(
        [str(part) for part in command],
        capture_output=True,
        text=True,
        cwd="/",
        env=kept | environment,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    run(sys.executable, "-m", "pip", "wheel", "--no-deps", "--wheel-dir", folder, CHECKOUT)
    return next(folder.glob("*.whl"))


def test_the_wheel_is_small_and_holds_code_types_and_content(wheel):
    assert wheel.stat().st_size <= LARGEST
    names = set(zipfile.ZipFile(wheel).namelist())
    expected = {
        str(path.relative_to(CHECKOUT))
        for path in (CHECKOUT / "hyperleg_design").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    for folder in ("descriptions", "motors", "sweeps", "sim"):
        expected |= {
            f"hyperleg_design/content/{path.relative_to(CHECKOUT)}"
            for path in (CHECKOUT / folder).rglob("*")
            if path.is_file() and "policies" not in path.parts
        }
    packaged = {name for name in names if ".dist-info/" not in name}
    assert packaged == expected
    assert "hyperleg_design/py.typed" in names


def test_the_wheel_works_in_a_clean_environment(wheel, tmp_path: Path):
    venv.create(tmp_path / "env", with_pip=True)
    python, hyperleg = (tmp_path / "env" / "bin" / name for name in ("python", "hyperleg"))
    constraints = CHECKOUT / "constraints.txt"
    run(python, "-m", "pip", "install", "--quiet", "--constraint", constraints, wheel)
    assert run(hyperleg, "--version").split()[1] == hyperleg_design.__version__
    found = json.loads(run(hyperleg, "analyze", "--design", "hyperleg", "--json"))
    assert found["total_mass"] == pytest.approx(32.0)
    built = json.loads(run(hyperleg, "build", "--out", tmp_path / "robot", "--json"))
    assert any(name.endswith(".urdf") for name in built["files"])
    assert json.loads(run(hyperleg, "list", "policies", "--json"))["policies"] == {}
    with_checkout = run(hyperleg, "list", "policies", "--json", HYPERLEG_HOME=str(CHECKOUT))
    assert "walk_upright-toe-0" in json.loads(with_checkout)["policies"]
