"""One look for all matplotlib figures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hyperleg_design.writing import write_bytes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

VARIANT_COLOUR = {
    "toe": "#c8602a",
    "toe_locked": "#8172b3",
    "toe_removed_matched": "#2f6db3",
    "toe_removed": "#6b7280",
    "toe_passive": "#2a8a5f",
}
"""Colour of each ablation, told apart by colour-blind readers too."""
VARIANT_LABEL = {
    "toe": "active toe",
    "toe_locked": "toe locked",
    "toe_removed_matched": "toe removed, mass kept",
    "toe_removed": "toe removed",
}
"""Name of each ablation in legends."""
LEG_COLOUR = {"left": "#c8602a", "right": "#2f6db3"}
"""Colour of each leg."""
INK, GREY = "#1d2129", "#6b7280"
"""Colours of lines and texts that are, or are not, the subject of a figure."""


def variant_colour(variant: str) -> str:
    """Look up the colour of an ablation; that of the active toe for a robot without ablations.

    Args:
        variant: name of the ablation.

    Returns:
        The colour.
    """
    return VARIANT_COLOUR.get(variant, VARIANT_COLOUR["toe"])


_STYLE: dict[str, Any] = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e5e7eb",
    "grid.linewidth": 0.8,
    "axes.axisbelow": True,
    "axes.titlesize": 11,
    "legend.frameon": False,
    "figure.dpi": 110,
    "savefig.bbox": "tight",
    "svg.hashsalt": "hyperleg",
}


@contextmanager
def figure_style() -> Iterator[None]:
    """Draw inside this block, without a screen and in the common look."""
    import matplotlib as mpl

    mpl.use("Agg", force=False)
    with mpl.rc_context(_STYLE):
        yield


def save(figure: Figure, path: str | Path, dpi: int = 150) -> Path:
    """Write a figure as PNG or SVG, by the ending of the file, and close it.

    The file is written whole or not at all, with the same bytes each time.

    Args:
        figure: the figure.
        path: of the file.
        dpi: resolution of PNG [1/inch].

    Returns:
        The path.
    """
    import io

    import matplotlib.pyplot as plt

    stream = io.BytesIO()
    kind = Path(path).suffix.lstrip(".")
    metadata = {"Software": None} if kind == "png" else {"Date": None}
    figure.savefig(stream, format=kind, dpi=dpi, metadata=metadata)
    plt.close(figure)
    return write_bytes(path, stream.getvalue())


def later(figure: Callable[..., Figure], *arguments: Any) -> Callable[[Path], Path]:
    """Make a function that draws and saves a figure when it is given a path.

    Args:
        figure: function that draws.
        arguments: of that function.

    Returns:
        The function.
    """

    def write(path: Path) -> Path:
        return save(figure(*arguments), path)

    return write
