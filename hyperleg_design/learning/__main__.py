"""`python -m hyperleg_design.learning --task=walk --design=toe --seed=0 --preset=laptop
--out=FOLDER`: one training.
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
    """Exit status: 0 done, 3 stopped with a checkpoint, 2 an error.

    Args:
        arguments: of the command line; the process's own by default.
        alterations: as `train` takes them.
        overlay: as `train` takes it.
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
    parser.add_argument("--start")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=1)
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
            start=given.start,
            threads=given.threads,
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
