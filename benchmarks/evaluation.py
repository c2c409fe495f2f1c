"""What an evaluation costs: ten trials of 15.5 s with all signals and measures, beside bare physics
of as many steps.

The policy stands (ankles answer to the pelvis's lean), since that needs no training and keeps both
feet in contact, which is the dearer half of walking. The gait measures of a walk add some 0.06 s a
trial. The ratio of processor times leaves out waiting, so it means something on a busy machine.

Run: python benchmarks/evaluation.py
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.policy import Policy
from hyperleg_design.evaluation.protocol import WalkProtocol
from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.model import simulation_model
from hyperleg_design.simulation.settings import Start
from hyperleg_design.simulation.tasks import load_task

TRIALS, SECONDS, REPEATS = 10, 15.5, 3
DESIGN = load_design()


def standing_policy() -> Policy:
    layout = layout_of(DESIGN)
    ankles = layout.joint_indices("ankle_pitch")

    def act(observation: np.ndarray) -> np.ndarray:
        action = np.zeros((len(observation), len(layout.joints)))
        action[:, ankles] = (2.0 * observation[:, 3] + 0.6 * observation[:, 1] + 0.1)[:, None]
        return action

    return act


def simulate_and_measure() -> None:
    protocol = WalkProtocol(
        trials=TRIALS, time_limit=SECONDS, start=Start(joint_position=0, tilt=0)
    )
    found = evaluate(standing_policy(), protocol, design=DESIGN, task=load_task("walk"), threads=1)
    assert set(found.outcomes) == {"timed_out"}


def bare_physics() -> None:
    from mujoco import batch

    made = batch.Batch(simulation_model(DESIGN), TRIALS, 1)
    made.reset(None, 0, 0)
    for _ in range(round(SECONDS / 0.02)):
        made.step(nstep=4)


def timed(work: Callable[[], None]) -> tuple[float, float]:
    """Least wall and processor time of some repeats [s]."""
    walls, processors = [], []
    for _ in range(REPEATS):
        wall, processor = time.perf_counter(), time.process_time()
        work()
        walls.append(time.perf_counter() - wall)
        processors.append(time.process_time() - processor)
    return min(walls), min(processors)


def main() -> None:
    simulate_and_measure()  # imports
    whole, bare = timed(simulate_and_measure), timed(bare_physics)
    print(
        f"{TRIALS} trials of {SECONDS} s, evaluated on one thread  {whole[0]:6.2f} s, "
        f"{whole[1]:.2f} s of processor"
    )
    print(
        f"bare physics of as many steps               {bare[0]:6.2f} s, {bare[1]:.2f} s of "
        f"processor"
    )
    print(f"evaluation over bare physics, processor time {whole[1] / bare[1]:5.2f}")


if __name__ == "__main__":
    main()
