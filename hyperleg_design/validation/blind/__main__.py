"""The process that makes a trial; prints the key's SHA-256.

Usage: `python -m hyperleg_design.validation.blind --cases N --seed S --out DIR`.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from hyperleg_design.errors import HyperlegError
from hyperleg_design.validation.blind.plan import PLANTS
from hyperleg_design.validation.blind.trial import make_here


def main() -> int:
    """Read the options and make the trial."""
    parser = argparse.ArgumentParser(
        prog="python -m hyperleg_design.validation.blind",
        description="Make a blind trial and seal its truth.",
    )
    parser.add_argument("--cases", type=int, required=True)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--plants", nargs="+", default=list(PLANTS))
    parser.add_argument("--duration", nargs=2, type=float, default=[10.0, 14.0])
    parser.add_argument("--progress", action="store_true")
    options = parser.parse_args()

    def say(digest: str) -> None:
        sys.stdout.write(f"sha256 of the key: {digest}\n")
        sys.stdout.flush()

    try:
        make_here(
            options.cases,
            options.seed,
            options.out,
            plants=options.plants,
            workers=options.workers,
            progress=options.progress,
            duration=(options.duration[0], options.duration[1]),
            say=say,
        )
    except HyperlegError as error:
        sys.stderr.write(f"hyperleg: {error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
