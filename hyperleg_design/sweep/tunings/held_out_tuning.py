"""Held-out designs of a spread as files, and fine-tunings of a policy to each of them.

OUT/NUMBER/          design.yaml of a held-out design, with its training and log; see `fine_tuning`
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hyperleg_design.evaluation.held_out import EACH
from hyperleg_design.evaluation.shipped import find_policy
from hyperleg_design.sweep.tunings.fine_tuning import FineTuning, fine_tune, write_design
from hyperleg_design.writing import MARKER, write_text

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign


def write_held_out(robots: Sequence[RobotDesign], out: str | Path) -> None:
    """Write each held-out design as a file that `hyperleg train --design` takes, and the marker of
    a folder of this program.

    Args:
        robots: the designs by number.
        out: folder; design 3 becomes `OUT/3/design.yaml`.

    Raises:
        OutputError: a file of this name holds another design.
    """
    write_text(Path(out) / MARKER, "made by hyperleg\n")
    for i, robot in enumerate(robots):
        write_design(robot, Path(out) / str(i))


def fine_tune_held_out(
    policy: str | Path,
    robots: Sequence[RobotDesign],
    steps: int,
    out: str | Path,
    *,
    workers: int,
    progress: bool = True,
) -> str:
    """Fine-tune a policy to each held-out design; killed, the same call goes on.

    Args:
        policy: to start from: an ONNX file or a shipped name.
        robots: the designs by number.
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
