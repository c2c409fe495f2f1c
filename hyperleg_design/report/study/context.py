"""What each part of the study's page gets and gives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from hyperleg_design.errors import HyperlegError
from hyperleg_design.report.page import Missing, Picture, Section
from hyperleg_design.robot.design import Design

FIGURES = "figures"
"""Folder of the figures beside the page."""


@dataclass(frozen=True)
class Context:
    """What every section of the study is made from: the designs and the folder of the page."""

    design: Design
    variants: dict[str, Design]
    folder: Path
    """Folder of the page."""
    policies: Path | None = None
    """Folder of trainings to evaluate; None for the shipped policies."""
    progress: bool = False
    """Show a bar in parts that take long."""

    def picture(
        self, name: str, caption: str, make: Callable[[Path], object], *, wide: bool = True
    ) -> Picture | Missing:
        """Make a figure; if this machine cannot draw it, only this figure is missing.

        Args:
            name: of the file, without its ending.
            caption: of the figure.
            make: draws the figure into a file.
            wide: whether it takes the width of the page.

        Returns:
            The picture, or why it is missing.
        """
        file = f"{FIGURES}/{name}.png"
        try:
            make(self.folder / file)
        except HyperlegError as error:
            return Missing(caption, str(error))
        return Picture(file, caption, wide)


@dataclass(frozen=True)
class Made:
    """A section and the headline numbers it gives."""

    section: Section
    facts: tuple[tuple[str, str], ...] = ()
