"""All cases on real logs.

Split, fixed with the version: recordings of the double pendulum's first day and the first motion of
the XL330 are for development; the double pendulum's other day, its chirp, swing-ups and compensated
run, the other motion of the XL330, and the robots SO-101 and Go2 as wholes are held out.
"""

from __future__ import annotations

import os
from pathlib import Path

from hyperleg_design import resources
from hyperleg_design.validation.benchmark.case import Case
from hyperleg_design.validation.real.a0 import a0_cases
from hyperleg_design.validation.real.go2 import go2_cases
from hyperleg_design.validation.real.so101 import so101_cases
from hyperleg_design.validation.real.xl330 import xl330_cases

DATA = "HYPERLEG_DATA"
"""Environment variable that names the folder of the logs."""


def data_folder() -> Path:
    """Folder of the real logs: what `HYPERLEG_DATA` names, else `../shared/data` beside the
    checkout.
    """
    chosen = os.environ.get(DATA)
    return Path(chosen) if chosen else resources.home().parent / "shared" / "data"


def real_cases() -> list[Case]:
    """All of them, whether or not their logs are there."""
    return [*a0_cases(), *xl330_cases(), *so101_cases(), *go2_cases()]
