"""Parts of a page, and figures drawn into its folder."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hyperleg_design.errors import HyperlegError
from hyperleg_design.report.page import Missing, Picture

FIGURES = "figures"
"""Folder of the figures beside the page."""


@dataclass(frozen=True)
class Part:
    """A titled piece of a page."""

    title: str
    content: Sequence[Any]


@dataclass(frozen=True)
class Drawer:
    """Draws figures into the folder of a page."""

    folder: Path
    prefix: str = ""
    """Text in front of each figure's name."""

    def together(
        self, jobs: Sequence[tuple[str, str, Callable[[Path], object], str, bool]]
    ) -> list[Picture | Missing]:
        """Draw figures side by side, in other processes.

        This is not for matplotlib, which shares its state.

        Args:
            jobs: arguments of one call each: name, caption, function that draws, ending of the
                file, and whether it is wide.

        Returns:
            In the order of the jobs.
        """
        with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            return list(pool.map(lambda job: self(*job[:4], wide=job[4], chart=False), jobs))

    def __call__(
        self,
        name: str,
        caption: str,
        make: Callable[[Path], object],
        suffix: str = ".png",
        *,
        wide: bool = True,
        chart: bool = True,
    ) -> Picture | Missing:
        """Draw a figure; if this machine cannot draw it, or trials do not suffice for it, only this
        figure is missing.

        Args:
            name: of the file, without its ending.
            caption: of the figure.
            make: draws the figure into a file.
            suffix: ending of the file.
            wide: whether it takes the width of the page.
            chart: whether it is lines on white, which a dark scheme may show inverted.

        Returns:
            The picture, or why it is missing.
        """
        file = f"{FIGURES}/{self.prefix}{name}{suffix}"
        try:
            make(self.folder / file)
        except HyperlegError as error:
            return Missing(caption, str(error))
        return Picture(file, caption, wide, chart)
