"""Held-out designs of a spread as files, and fine-tunings of a policy to each of them.

OUT/NUMBER/          design.yaml of a held-out design, with its training and log; see `fine_tuning`
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hyperleg_design.evaluation.held_out import EACH
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.shipped import find_policy
from hyperleg_design.simulation.design_spread import load_design_spread
from hyperleg_design.sweep.tunings.fine_tuning import FineTuning, fine_tune, write_design
from hyperleg_design.writing import MARKER, write_text

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign


def write_held_out(policy: str | Path, designs: str | Path, out: str | Path) -> list[RobotDesign]:
    """Write each held-out design as a file that `hyperleg train --design` takes, and the marker of
    a folder of this program.

    Args:
        policy: whose design the leaves of the spread are changed of: an ONNX file or a shipped
            name.
        designs: the spread, a shipped name or a file.
        out: folder; design 3 becomes `OUT/3/design.yaml`.

    Returns:
        The designs by number.

    Raises:
        InputError: no such policy or spread.
        OutputError: a file of this name holds another design.
    """
    spread = load_design_spread(designs)
    batch = spread.held_out_designs(load_policy(policy).design)
    robots = [batch.take(i) for i in range(spread.held_out)]
    write_text(Path(out) / MARKER, "made by hyperleg\n")
    for i, robot in enumerate(robots):
        write_design(robot, Path(out) / str(i))
    return robots


def fine_tune_held_out(
    policy: str | Path,
    robots: list[RobotDesign],
    steps: int,
    out: str | Path,
    *,
    workers: int,
    progress: bool = True,
) -> str:
    """Fine-tune a policy to each held-out design; killed, the same call goes on.

    Args:
        policy: to start from: an ONNX file or a shipped name.
        robots: of `write_held_out`.
        steps: policy steps for each design.
        out: folder, as in `write_held_out`.
        workers: trainings side by side, of one thread each.
        progress: show a bar.

    Returns:
        Path of the fine-tuned policies with `{}` in place of the design's number, as
        `check_held_out` takes it.

    Raises:
        InputError: the policy cannot be fine-tuned, or a training failed.
        OutputError: the folder holds other designs.
    """
    start = find_policy(policy, "--finetune")
    trainings = [
        FineTuning(start, robot, steps, Path(out) / str(i)) for i, robot in enumerate(robots)
    ]
    fine_tune(trainings, workers=workers, progress=progress)
    return str(Path(out) / EACH / trainings[0].result.relative_to(trainings[0].folder))
