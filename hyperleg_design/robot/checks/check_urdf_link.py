"""Whether a link of a URDF can be: its mass, inertia, drawings and meshes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.checks.mesh_files import is_there, of_package
from hyperleg_design.robot.checks.urdf_xml import check_origin, numbers, place_of

SIZES = {
    "box": ("size", 3),
    "cylinder": ("radius length", 1),
    "sphere": ("radius", 1),
    "capsule": ("radius length", 1),
}
"""Attributes of each primitive, and how many numbers each holds."""
LARGEST_GYRATION = 5.0
"""Radius of gyration past which a robot's link looks like a mistake of unit [m]."""

POINT = 1e-6
"""Radius of gyration up to which an inertia is that of a point, and its numbers what rounding left
of zero [m]."""
FRAME = 1e-3
"""Mass up to which a link that is fixed to another counts as a mere frame [kg]."""
BOX = "a box of edges a, b, c has m (b^2 + c^2) / 12 about a"


def is_point(mass: float, inertia: np.ndarray) -> bool:
    """Whether an inertia is zero but for rounding, compared with the mass.

    Args:
        mass: of the link [kg].
        inertia: about the centre of mass [kg m^2], of any shape.

    Returns:
        Whether no entry exceeds that of a body with the radius of gyration `POINT`.
    """
    return bool(np.all(np.abs(inertia) <= mass * POINT**2))


def check_link(link: Any, source: str | Path | None, *, carried: bool) -> list[Finding]:
    """Check one link of a URDF.

    Args:
        link: the element.
        source: file of the URDF, which says where meshes are; None leaves them out.
        carried: whether the link is fixed to another one, where a point without inertia does no
            harm.

    Returns:
        What is wrong with its mass, inertia, drawings and meshes.
    """
    meshes = [] if source is None else _meshes(link, source)
    return [*_inertial(link, carried), *_drawings(link), *meshes]


def _inertial(link: Any, carried: bool) -> list[Finding]:
    """Mass and inertia; `carried` says that the link is fixed to another, where a point without
    inertia does no harm.
    """
    part = link.find("inertial")
    if part is None:
        return []
    place = place_of(link)
    findings = check_origin(part, place)
    mass, inertia = part.find("mass"), part.find("inertia")
    weight = None if mass is None else numbers(mass.get("value"), 1)
    if weight is None:
        shown = None if mass is None else mass.get("value")
        findings.append(
            Finding(
                "error", place, f"mass is {shown!r}", "expects <mass value=...>, one number in kg"
            )
        )
    elif weight[0] < 0:
        findings.append(Finding("error", place, f"mass is {weight[0]:g} kg", "a mass is positive"))
    if inertia is None:
        return [
            *findings,
            Finding(
                "error", place, "has a mass but no <inertia>", "add ixx, iyy, izz, ixy, ixz, iyz"
            ),
        ]
    values = [
        numbers(inertia.get(key, "0" if key in ("ixy", "ixz", "iyz") else None), 1)
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    ]
    if any(v is None for v in values):
        return [
            *findings,
            Finding(
                "error",
                place,
                "inertia lacks a number",
                "expects ixx, iyy, izz, ixy, ixz, iyz in kg m^2",
            ),
        ]
    if weight is not None and weight[0] > 0:
        findings += _tensor(
            np.array([float(v[0]) for v in values if v is not None]),
            float(weight[0]),
            place,
            carried,
        )
    return findings


def _tensor(values: np.ndarray, mass: float, place: str, carried: bool) -> list[Finding]:
    xx, yy, zz, xy, xz, yz = values
    principal = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    shown = ", ".join(f"{v:.4g}" for v in principal)
    if is_point(mass, values):
        message = f"has a mass of {mass:g} kg but no inertia, as a point has"
        remedy = f"give it that of its body ({BOX})"
        if carried and mass <= FRAME:
            remedy = "leave out the inertial of a mere frame"
        return [Finding("warning" if carried else "error", place, message, remedy)]
    frame = carried and mass <= FRAME
    if principal[0] <= 1e-12 * principal[2]:
        harmless = frame or (carried and principal[0] >= -1e-12 * principal[2])
        return [
            Finding(
                "warning" if harmless else "error",
                place,
                f"inertia is not positive definite (principal moments {shown} kg m^2)",
                "leave out the inertial of a mere frame" if frame else "check signs and products",
            )
        ]
    if principal[2] > (principal[0] + principal[1]) * (1 + 1e-9):
        return [
            Finding(
                "warning" if frame else "error",
                place,
                f"no body has this inertia (principal moments {shown} kg m^2)",
                f"the largest must not exceed the sum of the others; correct them in the file "
                f"({BOX})",
            )
        ]
    gyration = math.sqrt(principal[2] / mass)
    if gyration > LARGEST_GYRATION:
        return [
            Finding(
                "warning",
                place,
                f"radius of gyration is {gyration:.3g} m",
                "check units: kg, m, kg m^2",
            )
        ]
    return []


def _drawings(link: Any) -> list[Finding]:
    findings = []
    for drawing in [*link.findall("visual"), *link.findall("collision")]:
        place = f"{drawing.tag} of {place_of(link)}"
        findings += check_origin(drawing, place)
        geometry = drawing.find("geometry")
        if geometry is None or len(geometry) != 1:
            findings.append(
                Finding(
                    "error",
                    place,
                    "has no geometry, or several",
                    "expects one of box, cylinder, sphere, mesh in <geometry>",
                )
            )
            continue
        attributes, count = SIZES.get(geometry[0].tag, ("", 0))
        for key in attributes.split():
            size = numbers(geometry[0].get(key), count)
            if size is None or np.any(size <= 0):
                findings.append(
                    Finding(
                        "error",
                        place,
                        f"{geometry[0].tag} has {key}={geometry[0].get(key)!r}",
                        "expects positive lengths in m",
                    )
                )
    return findings


def _meshes(link: Any, source: str | Path) -> list[Finding]:
    """Mesh files of a link that are not where the URDF says; those of ROS packages are left out."""
    findings = []
    for mesh in link.iter("mesh"):
        name = (mesh.get("filename") or "").removeprefix("file://")
        if not of_package(name) and not is_there(name, Path(source)):
            findings.append(
                Finding(
                    "error",
                    place_of(link),
                    f"has a mesh that is missing: filename = {name!r}",
                    "correct the path, which starts at the URDF's folder, or add the file",
                )
            )
    return findings
