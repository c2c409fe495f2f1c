"""Support functions of the torque set: ours, batched and one at a time, against a cvxpy problem
that is compiled once.

Prints medians and their ratios. Run: python benchmarks/zonotope_support.py
"""

from __future__ import annotations

import argparse
import json
import statistics
import time
from collections.abc import Callable

import cvxpy as cp
import numpy as np

from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.transmission import joint_from_motor
from hyperleg_design.sizing import zonotope
from hyperleg_design.sizing.envelope import motor_envelope


def median_seconds(work: Callable[[], object], repeats: int) -> float:
    """Median wall time of `repeats` calls [s]."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def measure(directions: int = 20, repeats: int = 7, seed: int = 0) -> dict[str, float]:
    """Time a direction of each [s], ratios of their medians, and the largest difference of their
    answers [Nm].
    """
    design = load_design("hyperleg")
    matrix, peak = joint_from_motor(design), motor_envelope(design).peak_torque
    many = np.random.default_rng(seed).normal(size=(100 * directions, len(matrix)))
    few = many[:directions]
    motor, direction = cp.Variable(len(peak)), cp.Parameter(len(matrix))
    problem = cp.Problem(cp.Maximize(direction @ (matrix @ motor)), [motor <= peak, motor >= -peak])

    def by_cvxpy() -> np.ndarray:
        found = []
        for one in few:
            direction.value = one
            found.append(problem.solve(solver=cp.CLARABEL))
        return np.array(found)

    difference = np.abs(by_cvxpy() - zonotope.support(matrix, -peak, peak, few)).max()
    ours = median_seconds(lambda: zonotope.support(matrix, -peak, peak, many), repeats) / len(many)
    single = median_seconds(
        lambda: [zonotope.support(matrix, -peak, peak, one) for one in few], repeats
    ) / len(few)
    theirs = median_seconds(by_cvxpy, repeats) / len(few)
    return {
        "ours_seconds_per_direction": ours,
        "ours_single_seconds_per_direction": single,
        "cvxpy_seconds_per_direction": theirs,
        "ratio": theirs / ours,
        "ratio_single": theirs / single,
        "largest_difference_nm": float(difference),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--directions", type=int, default=20, help="directions that cvxpy solves in each repeat"
    )
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    found = measure(options.directions, options.repeats)
    if options.json:
        print(json.dumps(found))
        return
    for name, seconds, ratio in (
        ("cvxpy", found["cvxpy_seconds_per_direction"], 1.0),
        ("ours, one at a time", found["ours_single_seconds_per_direction"], found["ratio_single"]),
        ("ours, batched", found["ours_seconds_per_direction"], found["ratio"]),
    ):
        print(f"{name:20} {seconds * 1e6:9.3f} us a direction, {ratio:7.0f} times as fast as cvxpy")
    print(f"largest difference   {found['largest_difference_nm']:.1e} Nm")


if __name__ == "__main__":
    main()
