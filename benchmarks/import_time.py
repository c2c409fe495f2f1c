"""Time that `import hyperleg_design` takes, beside `import numpy`, each in a fresh interpreter.

Run: python benchmarks/import_time.py
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time

REPEATS = 11


def median_seconds(code: str) -> float:
    """Median duration of a fresh interpreter that runs the code [s]."""
    durations = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True)
        durations.append(time.perf_counter() - start)
    return statistics.median(durations)


def main() -> None:
    bare = median_seconds("pass")
    for name in ("numpy", "hyperleg_design", "hyperleg_design.robot.design", "hyperleg_design.cli"):
        own = median_seconds(f"import {name}") - bare
        print(f"import {name:30} {own:6.3f} s above a bare interpreter ({bare:.3f} s)")


if __name__ == "__main__":
    main()
