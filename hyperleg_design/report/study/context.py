"""What each part of the study's page gets and gives."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from hyperleg_design.report.drawer import Drawer
from hyperleg_design.report.page import Section
from hyperleg_design.robot.design import Design


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

    @property
    def picture(self) -> Drawer:
        """Draws figures into the folder of the page."""
        return Drawer(self.folder)


@dataclass(frozen=True)
class Made:
    """A section and the headline numbers it gives."""

    section: Section
    facts: tuple[tuple[str, str], ...] = ()
