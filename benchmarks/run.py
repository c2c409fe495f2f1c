"""Runs every benchmark of this folder, one after the other.

Run: make benchmark
"""

from __future__ import annotations

import runpy
from pathlib import Path


def main() -> None:
    for path in sorted(Path(__file__).parent.glob("*.py")):
        if path.name != "run.py":
            print(f"== {path.stem}")
            runpy.run_path(str(path), run_name="__main__")


if __name__ == "__main__":
    main()
