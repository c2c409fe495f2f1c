"""Time from a design's YAML to a compiled MuJoCo model, after imports, and what the parts of it
cost.

Run: python benchmarks/design_to_model.py
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

REPEATS = 30


def median_ms(job: Callable[[], object]) -> float:
    """Median duration of a job [ms]."""
    durations = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        job()
        durations.append(time.perf_counter() - start)
    return 1e3 * statistics.median(durations)


def main() -> None:
    from hyperleg_design.robot.description import urdf
    from hyperleg_design.robot.design import load_design
    from hyperleg_design.robot.mjcf import mujoco_model
    from hyperleg_design.robot.models import rigid_body_model

    design = load_design("hyperleg")
    mujoco_model(design)
    rows = {
        "YAML to design": lambda: load_design("hyperleg"),
        "design to URDF (xacro)": lambda: urdf(design),
        "design to Pinocchio": lambda: rigid_body_model(design),
        "design to MuJoCo": lambda: mujoco_model(design),
        "YAML to MuJoCo": lambda: mujoco_model(load_design("hyperleg")),
    }
    found = {name: median_ms(job) for name, job in rows.items()}
    for name, value in found.items():
        print(f"{name:24} {value:7.1f} ms   {value / found['YAML to MuJoCo']:5.2f} of the whole")


if __name__ == "__main__":
    main()
