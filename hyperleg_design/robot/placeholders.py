"""Links of a URDF or MJCF that stand for no body, and what an import takes as their inertia."""

from __future__ import annotations

import numpy as np

from hyperleg_design.robot.checks.check_urdf_link import is_point
from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.described_file import FileLink, FileRobot

DUMMY_INERTIA = 1e-5
"""Moment of inertia up to which a link is a placeholder, as root links of URDFs often are, and gets
the moments of a ball where it has those of no body [kg m^2]."""


def real_inertia(link: FileLink) -> np.ndarray:
    """Compute the inertia of a link that a body can have.

    Args:
        link: of the file.

    Returns:
        Its inertia; of a point, zero, and of a placeholder with moments of no body, a ball's with
        the largest of them [kg m^2], `(3, 3)`.
    """
    inertia = link.inertia
    if is_point(link.mass, inertia):
        return np.zeros((3, 3))
    low, middle, high = np.linalg.eigvalsh(inertia)
    real = low > 0 and high <= (low + middle) * (1 + 1e-6)
    if real or not 0 < high < DUMMY_INERTIA:
        return inertia
    return float(high) * np.eye(3)


def placeholders(robot: FileRobot) -> list[Finding]:
    """Find the links whose inertia no body has, but that are too small to matter.

    Args:
        robot: the file.

    Returns:
        Warnings that name what is taken in its place.
    """
    remedy = "its largest moment is taken in all directions; correct it in the file"
    findings = []
    for name, link in robot.links.items():
        if not is_point(link.mass, link.inertia) and real_inertia(link) is not link.inertia:
            moments = ", ".join(f"{v:.4g}" for v in np.linalg.eigvalsh(link.inertia))
            message = f"no body has this inertia (principal moments {moments} kg m^2)"
            findings.append(Finding("warning", f"link {name}", message, remedy))
    return findings
