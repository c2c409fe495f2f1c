"""Evaluate a changed robot: what a heavier toe and a softer sole do to a policy that was trained
without them.

Takes an ONNX policy: one of `hyperleg train`, or by default the first that is shipped. Where there
is none, a policy that holds the default posture is evaluated instead: it falls, and the numbers say
so.

Run: python examples/evaluate_your_own_robot.py [POLICY.onnx]
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
    one.path for one in shipped_policies(late=False) if one.group == "walk" and one.design == "toe"
]
file = sys.argv[1] if len(sys.argv) > 1 else walkers[0] if walkers else None
policy = load_policy(file) if file else standing(14)
own = policy.design if file else hl.load_design("hyperleg")
task = policy.task if file else load_task("walk")

robots = {
    "as trained": own,
    "toe 0.2 kg heavier": own.with_values({"toe.mass": float(own.toe.mass) + 0.2}),
    "softer sole": own.with_values({"contact.time_constant": 0.03}),
}
protocol = load_protocol("walk").changed(trials=4)
print(
    f"{getattr(policy, 'name', 'standing')}: {protocol.distance:g} m at {protocol.speed:g} m/s, "
    f"{int(protocol.trials)} trials each"
)
for name, robot in robots.items():
    found = evaluate(policy, protocol, design=robot, task=task)
    power, transport, peak = (
        estimate([found.values(m)]) for m in ("power", "cost_of_transport", "grf_peak")
    )
    print(f"{name:<20} {', '.join(found.outcomes)}")
    print(
        f"{'':<20} power {power.mean:.0f} W, CoT {transport.mean:.3f}, heel strike {peak.mean:.0f} "
        f"N"
    )
