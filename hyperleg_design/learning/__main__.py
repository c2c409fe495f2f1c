"""Run one training in this process.

Usage: `python -m hyperleg_design.learning --task=walk --design=toe --seed=0 --preset=laptop
--out=FOLDER`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hyperleg_design.errors import HyperlegError
from hyperleg_design.learning import launch

if TYPE_CHECKING:
    from hyperleg_design.simulation.alteration import Alterations


def main(
    arguments: Sequence[str] | None = None,
    alterations: Alterations | None = None,
    overlay: Mapping[str, Any] | None = None,
) -> int:
    """Run or continue one training, and say how it ended.

    Args:
        arguments: options of the command line; the options of this process by default.
        alterations: changes of the simulated robot, as `train` takes them.
        overlay: description of these changes, as `train` takes it.

    Returns:
        The exit status: 0 when the training is done, 3 when it stopped with a checkpoint before
        its end, and 2 after an error.
    """
    parser = argparse.ArgumentParser(
        prog="python -m hyperleg_design.learning", description="One training, or the rest of one."
    )
    for name in ("task", "design", "preset", "out"):
        parser.add_argument(
            f"--{name}",
            required=name == "out",
            default={"task": "walk", "design": "toe", "preset": "laptop"}.get(name),
        )
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--set-file", action="append", default=[])
    parser.add_argument("--start")
    parser.add_argument("--designs")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--iterations", type=int)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--device", default="cpu")
    given = parser.parse_args(arguments)
    if arguments is None and not launch.surrounded():
        launch.run_here(sys.argv[1:], given.threads)
    from hyperleg_design.learning.train import train

    try:
        done = train(
            given.task,
            given.design,
            given.seed,
            given.preset,
            given.out,
            overrides=given.set,
            overlays=given.set_file,
            start=given.start,
            designs=given.designs,
            threads=given.threads,
            device=given.device,
            iterations=given.iterations,
            alterations=alterations,
            overlay=overlay,
            show=_show,
        )
    except HyperlegError as error:
        sys.stderr.write(f"hyperleg: {error}\n")
        return 2
    return 0 if done else 3


def _show(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
