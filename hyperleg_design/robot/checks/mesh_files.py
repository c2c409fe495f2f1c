"""Whether the meshes that a URDF names are there."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from hyperleg_design.robot.checks.finding import Finding

SCHEME = re.compile(r"^(package|file|model)://")
WITHOUT = (
    "put it where the file says, or import with --no-meshes (drawings are not taken over in any "
    "case)"
)
"""What to do about a mesh that an import misses."""


def of_package(name: str) -> bool:
    """Whether a mesh lies in a ROS package, which may be installed anywhere.

    Args:
        name: as the URDF gives it.
    """
    return "://" in name and not name.startswith("file://")


def is_there(name: str, path: Path) -> bool:
    """Look for a mesh.

    Args:
        name: as the URDF gives it: a path from the URDF's folder, or one that begins with `file://`
            or with `package://NAME/`, which is looked for in the folders above the URDF.
        path: of the URDF.

    Returns:
        Whether there is such a file.
    """
    plain = SCHEME.sub("", name)
    if not plain:
        return False
    if not of_package(name):
        return (path.parent / plain).is_file()
    inside = plain.split("/", 1)[-1]
    return any(
        place.is_file()
        for folder in path.resolve().parents
        for place in (folder / plain, folder / inside)
    )


def missing_meshes(root: Any, path: Path) -> list[str]:
    """List the meshes of a URDF that are not there.

    Args:
        root: element of the URDF.
        path: of its file.

    Returns:
        Their names as the file gives them, each once.
    """
    names = dict.fromkeys(str(mesh.get("filename", "")) for mesh in root.iter("mesh"))
    return [name for name in names if not is_there(name, path)]


def check_packages(root: Any, path: Path) -> list[Finding]:
    """Check the meshes that a URDF finds through ROS packages, which may be installed elsewhere.

    Args:
        root: element of the URDF.
        path: of its file.

    Returns:
        A warning where one is not in the folders above the file; none otherwise.
    """
    missing = [name for name in missing_meshes(root, path) if of_package(name)]
    if not missing:
        return []
    first = missing[0] if len(missing) == 1 else f"{len(missing)} files such as {missing[0]}"
    message = f"{first}: not in the folders above this file"
    remedy = "import takes the robot with --no-meshes only, unless they are put there"
    return [Finding("warning", "<mesh filename>", message, remedy)]
