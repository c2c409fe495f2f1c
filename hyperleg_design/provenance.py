"""What made a result: versions and commit. No date, so that the same inputs give the same bytes."""

from __future__ import annotations

import subprocess
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from hyperleg_design import resources

PACKAGES = ("hyperleg-design", "numpy", "mujoco", "pin", "cvxpy")


def versions(packages: tuple[str, ...] = PACKAGES) -> dict[str, str]:
    """List the versions of packages.

    Args:
        packages: their names.

    Returns:
        The installed version of each; `missing` where it is not installed.
    """
    installed = {}
    for name in packages:
        try:
            installed[name] = version(name)
        except PackageNotFoundError:
            installed[name] = "missing"
    return installed


@cache
def git_commit(folder: Path | None = None) -> str:
    """Find the commit of the checkout that holds the content folders.

    Args:
        folder: of the checkout; that of the content by default.

    Returns:
        The short hash, with `-dirty` for local changes; empty outside of a checkout.
    """
    folder = folder or resources.home()
    if not (folder / ".git").exists():
        return ""
    try:
        commit = _git(folder, "rev-parse", "--short=12", "HEAD")
        return (
            f"{commit}-dirty"
            if _git(folder, "status", "--porcelain", "--untracked-files=no")
            else commit
        )
    except (OSError, subprocess.SubprocessError):
        return ""


def _git(folder: Path, *arguments: str) -> str:
    done = subprocess.run(
        ["git", "-C", str(folder), *arguments],
        capture_output=True,
        text=True,
        timeout=10,
        check=True,
    )
    return done.stdout.strip()
