"""Designs a second of the batched sizing sweep, beside a loop that builds and solves every design
by itself.

The loop does for each design what one does without batching: xacro to URDF, Pinocchio (total mass,
swing inertia by CRBA), and cvxpy for the envelope: largest torque of each joint, and of each joint
below the hip with the others there at zero. Its convex problem is compiled once and only gets new
numbers, which favours the loop. The sweep computes those and all other sizing measures. Both run on
the same designs and their results are compared. Ratios are of medians within this run.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from hyperleg_design.robot import transmission
from hyperleg_design.robot.design import Design
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.robot.names import JOINTS
from hyperleg_design.sizing.envelope import motor_envelope
from hyperleg_design.sweep.measuring import measures
from hyperleg_design.sweep.measuring.evaluate import evaluate_samples
from hyperleg_design.sweep.space import sweep_from_mapping
from hyperleg_design.sweep.spaces.definition import Sweep

TARGET_RATIO, TARGET_MEMORY = 200.0, 4.0
LOOP_DESIGNS, BATCH, REPEATS = 15, 4096, 7
SIZES = (1_000, 10_000, 100_000)


def definition(count: int) -> Sweep:
    """Reductions, toe mass, lengths and motors."""
    axes = {
        "knee": {"paths": ["transmission.scale.knee"], "scale": {"low": 0.5, "high": 2.0}},
        "ankle": {
            "paths": ["transmission.scale.ankle_pitch", "transmission.scale.toe_ankle_pitch"],
            "scale": {"low": 0.5, "high": 2.0},
        },
        "toe.mass": {"low": 0.1, "high": 0.5},
        "leg": {"paths": ["thigh.length", "shank.length"], "scale": {"low": 0.8, "high": 1.2}},
        "actuators.knee.motor": {"values": ["RI60", "RI70", "RI80"]},
    }
    return sweep_from_mapping(
        {
            "name": "benchmark",
            "design": "hyperleg",
            "sampling": "random",
            "count": count,
            "axes": axes,
        }
    )


def envelope_solver() -> Callable[..., float]:
    """A function that solves for the largest torque of one joint, others at zero where `held` is
    1.
    """
    import cvxpy as cp

    torque, motor = cp.Variable(7), cp.Variable(7)
    matrix, peak = cp.Parameter((7, 7)), cp.Parameter(7, nonneg=True)
    direction, held = cp.Parameter(7), cp.Parameter(7, nonneg=True)
    limits = [
        torque == matrix @ motor,
        motor <= peak,
        motor >= -peak,
        cp.multiply(held, torque) == 0,
    ]
    problem = cp.Problem(cp.Maximize(direction @ torque), limits)

    def solve(m: np.ndarray, limit: np.ndarray, joint: int, zero: list[int]) -> float:
        matrix.value, peak.value = m, limit
        direction.value, held.value = np.eye(7)[joint], np.isin(np.arange(7), zero).astype(float)
        return float(problem.solve(solver=cp.CLARABEL))

    return solve


def one_by_one(design: Design, solve: Callable[..., float]) -> dict[str, float]:
    """What the loop finds of one design."""
    model = rigid_body_model(design, floating=False)  # design -> xacro -> URDF -> Pinocchio
    inertia = model.mass_matrix(model.neutral()) - model.reflected
    found = {
        "total_mass": float(sum(link.mass for link in model.tree.links)),
        "swing_inertia": float(inertia[2, 2]),
    }
    peak = motor_envelope(design).peak_torque
    standing, walking = (
        transmission.joint_from_motor(design, posture) for posture in ("standing", "walking")
    )
    derate = transmission.derate(design)
    for joint, name in enumerate(JOINTS):
        found[f"max_joint_torque.{name}"] = derate[joint] * solve(standing, peak, joint, [])
    for joint in range(3, 7):
        found[f"torque_alone.{JOINTS[joint]}"] = solve(
            walking, peak, joint, [j for j in range(3, 7) if j != joint]
        )
    return found


def compare() -> dict[str, float]:
    """Median seconds a design of both ways, and the largest relative difference of their
    results.
    """
    sweep = definition(BATCH)
    samples = sweep.samples()
    solve = envelope_solver()
    designs = sweep.design(
        {name: values[: LOOP_DESIGNS + 1] for name, values in samples.items()}, "toe"
    )
    one_by_one(designs.take(LOOP_DESIGNS), solve)  # imports and compilation stay out of the times
    columns = list(measures.columns(sweep.measures))
    values, _ = evaluate_samples(sweep, samples, "toe")
    loop, batched, worst = [], [], 0.0
    for repeat in range(max(LOOP_DESIGNS, REPEATS)):
        if repeat < LOOP_DESIGNS:
            design = designs.take(repeat)
            start = time.perf_counter()
            found = one_by_one(design, solve)
            loop.append(time.perf_counter() - start)
            worst = max(
                worst, *(abs(v / values[columns.index(c), repeat] - 1) for c, v in found.items())
            )
        if repeat < REPEATS:
            start = time.perf_counter()
            evaluate_samples(sweep, samples, "toe")
            batched.append((time.perf_counter() - start) / BATCH)
    return {
        "loop": statistics.median(loop),
        "batched": statistics.median(batched),
        "difference": worst,
    }


def scale(count: int) -> dict[str, float]:
    """Seconds and peak memory [GiB] of a whole run in a process of its own, table written; imports
    not counted.
    """
    done = subprocess.run(
        [sys.executable, __file__, "--run", str(count)], capture_output=True, text=True, check=True
    )
    seconds, memory = done.stdout.split()
    return {"seconds": float(seconds), "memory": float(memory)}


def run_one(count: int) -> None:
    """Run a sweep and print its seconds and peak memory [GiB]."""
    import resource

    from hyperleg_design.sweep.run import run_sweep

    with tempfile.TemporaryDirectory() as folder:
        run_sweep(definition(100), f"{folder}/first", progress=False)  # imports
        sweep = definition(count)
        start = time.perf_counter()
        run_sweep(sweep, f"{folder}/out", progress=False)
        seconds = time.perf_counter() - start
    print(seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20)


def measure() -> dict[str, Any]:
    """All numbers of this benchmark."""
    found: dict[str, Any] = compare()
    found["ratio"] = found["loop"] / found["batched"]
    found["scale"] = {count: scale(count) for count in SIZES}
    return found


def main() -> None:
    """Measure, and print a table."""
    if sys.argv[1:2] == ["--run"]:
        run_one(int(sys.argv[2]))
        return
    found = measure()
    print(f"{'':34}{'designs/s':>12}{'ms/design':>12}")
    print(
        f"{'loop: xacro, Pinocchio, cvxpy':34}{1 / found['loop']:12.1f}{1e3 * found['loop']:12.2f}"
    )
    print(
        f"{f'batched, {BATCH} at a time':34}{1 / found['batched']:12.0f}{1e3 * found['batched']:12.4f}"  # noqa: E501
    )
    verdict = "reached" if found["ratio"] >= TARGET_RATIO else "MISSED"
    print(f"ratio of medians: {found['ratio']:.0f} (target {TARGET_RATIO:.0f}, {verdict})")
    print(f"largest relative difference of the results: {found['difference']:.1e}\n")
    print(f"{'whole run, table written':34}{'designs/s':>12}{'seconds':>12}{'peak GiB':>12}")
    for count, run in found["scale"].items():
        print(
            f"{count:<34}{count / run['seconds']:12.0f}{run['seconds']:12.2f}{run['memory']:12.2f}"
        )
    most = found["scale"][max(SIZES)]["memory"]
    print(
        f"peak memory of {max(SIZES)} designs: {most:.2f} GiB (target {TARGET_MEMORY:.0f}, "
        f"{'reached' if most < TARGET_MEMORY else 'MISSED'})"
    )


if __name__ == "__main__":
    main()
