"""The part of a gap that no named cause explains, described by the simplest law that fits: constant
and viscous friction before any other shape.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.gap.model.joint_units import joint_unit
from hyperleg_design.gap.pipeline.detected_causes import APART
from hyperleg_design.gap.playback.evidence import Evidence
from hyperleg_design.gap.playback.sheets import root_mean_square

TURN = 0.05
"""Speed over which friction turns its direction in this fit [rad/s]."""
PLAIN = 0.5
"""Share of the mean square that friction must explain to be named."""
NEARLY = 0.8
"""Share of what another shape would explain that friction must explain to be named instead [-]."""


@dataclass(frozen=True)
class Friction:
    """Least-squares fit of friction to what is left of one joint's torque."""

    constant: float
    """Coulomb friction [Nm, or N where the joint slides]."""
    viscous: float
    """Viscous friction [Nms/rad, or Ns/m]."""
    share: float
    """Share of the mean square that friction explains [-]."""
    slides: bool = False
    """Whether the joint slides."""

    @property
    def sizes(self) -> str:
        """Both kinds of friction, each with its unit."""
        units = [joint_unit(unit, self.slides) for unit in ("Nm", "Nms/rad")]
        return f"{self.constant:.2g} {units[0]} and {self.viscous:.2g} {units[1]}"

    def sentence(self, joint: str) -> str:
        """Describe the remaining friction of a joint in one sentence.

        Args:
            joint: name of the joint.

        Returns:
            The sentence.
        """
        return (
            f"Left at {joint}: a {'force' if self.slides else 'torque'} that goes with its speed. "
            f"Plain friction of {self.sizes} would explain "
            f"{100 * self.share:.0f} % of it, though another shape is more probable."
        )


def friction(shown: Sequence[Evidence], row: int) -> Friction:
    """Fit `constant tanh(v / TURN) + viscous v + offset` to what is left of a row in all logs.

    Args:
        shown: of the motion residual of one robot's logs.
        row: of the joint.

    Returns:
        The fit, and how much of what is left it explains.
    """
    speed, left = (
        np.concatenate(part)
        for part in ([s.speed[:, row] for s in shown], [s.after[:, row] for s in shown])
    )
    known = np.isfinite(speed) & np.isfinite(left)
    speed, left = speed[known], left[known]
    if len(left) < 10 or not left.any():
        return Friction(0.0, 0.0, 0.0)
    columns = np.column_stack([np.tanh(speed / TURN), speed, np.ones_like(speed)])
    fit, *_ = np.linalg.lstsq(columns, left, rcond=None)
    # friction resists: a residual is what the motion lacks, so its sign is that of the speed
    rest = left - columns @ fit
    share = 1.0 - float(rest @ rest) / float(left @ left)
    resists = fit[0] >= 0 and fit[0] + fit[1] * float(np.abs(speed).max()) >= 0
    slides = shown[0].units[row] == joint_unit("Nm", True)
    return Friction(float(fit[0]), float(fit[1]), share if resists else 0.0, slides)


def hints(shapes: Sequence[Mapping[str, Any]], shown: Sequence[Evidence]) -> list[str]:
    """Describe what is left of a gap: plain friction where it fits nearly as well as the shape that
    was found, else that shape; and what feet do that slide or sink.

    Args:
        shapes: `residual_shape` of the diagnosis, the largest first.
        shown: evidence of its logs, all of one residual.

    Returns:
        Sentences.
    """
    alike = [part for part in shown if part.residual_name == "motion"]
    rows = alike[0].rows if alike else ()
    fits = [friction(alike, row) for row in range(len(rows))]
    sentences: dict[str, None] = {}
    for shape in shapes:
        place = str(shape["location"])
        if shape.get("shape") in APART:
            sentences[f"{place} {shape['says']}."] = None
            continue
        enough = max(PLAIN, NEARLY * float(shape.get("closed_beyond", 0.0)))
        if place in rows:
            fit = fits[rows.index(place)]
            plain = fit.sentence(place) if fit.share >= enough else ""
        else:
            plain = _everywhere(alike, fits, enough)
        if plain:
            sentences[plain] = None
            continue
        sentence = str(shape["says"]).removeprefix(place).lstrip(": ")
        where = "" if place == "robot" else f" at {place}"
        sentences[f"Left{where}: {sentence}."] = None
    return list(sentences)


def _everywhere(shown: Sequence[Evidence], fits: Sequence[Friction], enough: float) -> str:
    """A sentence on friction of all joints, where it explains enough of what is left of them."""
    if not shown:
        return ""
    squares = (
        np.nan_to_num(root_mean_square(np.concatenate([evidence.after for evidence in shown]))) ** 2
    )
    share = float(squares @ [fit.share for fit in fits]) / max(float(squares.sum()), 1e-300)
    if share < enough:
        return ""
    sizes = ", ".join(
        f"{joint} {fit.sizes}"
        for joint, fit in zip(shown[0].rows, fits, strict=True)
        if fit.share >= PLAIN
    )
    return (
        "Left: torques that go with the joints' speeds. Plain friction would explain "
        f"{100 * share:.0f} % of what is left ({sizes}), though another "
        "shape is more probable."
    )
