"""Evaluate a changed robot: what a heavier toe and a softer sole do to a policy that was trained
without them.

Takes an ONNX policy of `hyperleg train`, or the name of a shipped training. Where none is given or
shipped, a policy that holds the default posture is evaluated instead: it falls, and the numbers say
so.

Run: python examples/evaluate_your_own_robot.py [POLICY]
"""

import sys

import hyperleg_design as hl
from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.policy import load_policy, standing
from hyperleg_design.evaluation.protocol import load_protocol
from hyperleg_design.evaluation.shipped import shipped_policies
from hyperleg_design.evaluation.statistics import estimate
from hyperleg_design.simulation.tasks import load_task

walkers = [
    policy.training
    for policy in shipped_policies(late=False)
    if (policy.group, policy.design) == ("walk_upright", "toe")
]
name = sys.argv[1] if len(sys.argv) > 1 else walkers[1] if walkers else ""
policy = load_policy(name) if name else standing(14)
own = policy.design if name else hl.load_design("hyperleg")
task = policy.task if name else load_task("walk")

robots = {
    "as trained": own,
    "toe 0.2 kg heavier": own.with_values({"toe.mass": float(own.toe.mass) + 0.2}),
    "softer sole": own.with_values({"contact.time_constant": 0.03}),
}
protocol = load_protocol("walk").changed(trials=4)
print(
    f"{name or 'standing'}: {protocol.distance:g} m at {protocol.speed:g} m/s, "
    f"{int(protocol.trials)} trials each"
)
for robot_name, robot in robots.items():
    evaluation = evaluate(policy, protocol, design=robot, task=task)
    power, transport, peak = (
        estimate([evaluation.values(m)]) for m in ("power", "cost_of_transport", "grf_peak")
    )
    print(f"{robot_name:<20} {', '.join(evaluation.outcomes)}")
    print(
        f"{'':<20} power {power.mean:.0f} W, cost of transport {transport.mean:.3f}, "
        f"heel strike {peak.mean:.0f} N"
    )
