"""What the simulation step does to a policy's measures, and what the stops do to its joints.

Run: python benchmarks/step_convergence.py walk_upright-toe-0 t_test_free-toe-0
[--trials 10] [--set stops.time_constant=0.005 stops.impedance=0.99]

Each policy runs its protocol on the robot that it was trained on, at four steps of the simulation;
the policy acts every 20 ms in all of them.
"""

from __future__ import annotations

import argparse
import dataclasses

import numpy as np

STEPS = ((0.005, 4), (0.0025, 8), (0.002, 10), (0.001, 20))
"""Simulation step [s] and steps between two actions."""
MEASURES = (
    "cost_of_transport",
    "mean_speed",
    "grf_peak",
    "cadence",
    "stop_overshoot",
    "stop_absorbed_power",
    "stop_returned_power",
)


def main() -> None:
    from hyperleg_design.evaluation.evaluate import evaluate
    from hyperleg_design.evaluation.policy import load_policy
    from hyperleg_design.evaluation.protocol import load_protocol
    from hyperleg_design.robot.design import parse_overrides
    from hyperleg_design.simulation.waypoint_commands import WaypointCommands

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("policies", nargs="+")
    parser.add_argument("--trials", type=int, default=10)
    parser.add_argument("--set", nargs="*", default=[])
    options = parser.parse_args()
    print("policy, step [ms], outcomes", *MEASURES, sep=", ")
    for name in options.policies:
        policy = load_policy(name)
        kind = "t_test" if isinstance(policy.task.commands, WaypointCommands) else "walk"
        protocol = dataclasses.replace(load_protocol(kind), trials=options.trials)
        design = policy.design.with_values(parse_overrides(options.set), "--set")
        for step, substeps in STEPS:
            physics = dataclasses.replace(policy.task.physics, time_step=step, substeps=substeps)
            found = evaluate(
                policy, protocol, design=design, task=policy.task.changed(physics=physics)
            )
            arrived = found.outcomes.count("arrived")
            rows = [[trial.get(m, np.nan) for m in MEASURES] for trial in found.measures]
            means = [f"{value:.4g}" for value in np.nanmean(rows, 0)]
            outcome = f"{arrived}/{len(rows)} arrived"
            print(name, f"{1e3 * step:g}", outcome, *means, sep=", ", flush=True)


if __name__ == "__main__":
    main()
