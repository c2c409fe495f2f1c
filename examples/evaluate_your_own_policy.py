"""Evaluate your own policy on your own robot: any function of observations, the shipped walk,
numbers with intervals.

The policy here knows no walking: its ankles answer to the lean of the pelvis, so the robot stands
and sways. An ONNX file of `hyperleg train` is evaluated by `evaluate("policy.onnx")` alone, since
it brings its robot and task.

Run: python examples/evaluate_your_own_policy.py
"""

import numpy as np

import hyperleg_design as hl
from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.protocol import load_protocol
from hyperleg_design.evaluation.statistics import estimate, share
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.tasks import load_task

robot = hl.load_design("hyperleg", overrides={"toe.mass": 0.3})
ankles = layout_of(robot).joint_indices("ankle_pitch")


def policy(observation):
    """Actions (n, joints) from observations (n, size): pelvis rates, gravity in its frame, command,
    joints, last actions.
    """
    action = np.zeros((len(observation), 14))
    action[:, ankles] = (2.0 * observation[:, 3] + 0.6 * observation[:, 1] + 0.1)[:, None]
    return action


protocol = load_protocol("walk").changed(trials=6, time_limit=16.0)
found = evaluate(policy, protocol, design=robot, task=load_task("walk"))
print("outcomes      ", *found.outcomes)
print("falls         ", share([found.values("fell")]).text())
print("power [W]     ", estimate([found.values("power")]).text())
print("largest tilt  ", estimate([found.values("largest_tilt")]).text())
