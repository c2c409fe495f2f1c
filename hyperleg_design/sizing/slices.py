"""Exact cuts and shadows of a torque zonotope in two and three joints, to look at.

A cut holds some joints at given torques; joints that are neither shown nor held may have any
torque, which projects them away. One set at a time: `matrix` `(joints, motors)`, `lower` and
`upper` `(motors,)`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.sizing.zonotope import halfspaces

_TOUCHES = 1e-9
"""Distance at which a point lies on a facet, over the largest motor torque limit [-]."""


@dataclass(frozen=True, eq=False)
class Polyhedron:
    """A convex body with flat faces."""

    vertices: np.ndarray
    """Corners of the body [Nm], `(vertices, 3)`."""
    faces: tuple[np.ndarray, ...]
    """Vertex indices around each face, anticlockwise from outside."""

    @property
    def triangles(self) -> np.ndarray:
        """Faces cut into triangles, `(triangles, 3)` indices, anticlockwise from outside."""
        return np.array(
            [
                (face[0], face[i], face[i + 1])
                for face in self.faces
                for i in range(1, len(face) - 1)
            ]
        )

    @property
    def volume(self) -> float:
        """Volume of the body [Nm^3]."""
        a, b, c = np.moveaxis(self.vertices[self.triangles], 1, 0)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def slice_polygon(
    matrix: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    joints: tuple[int, int],
    held: Mapping[int, float] | None = None,
) -> np.ndarray:
    """Torques that two joints can have together while others are held.

    Args:
        matrix: `(joints, motors)` [-].
        lower: `(motors,)` [Nm].
        upper: `(motors,)` [Nm].
        joints: rows of the two joints.
        held: torque [Nm] by row; all other joints at zero by default. Rows left out are free.

    Returns:
        Vertices in anticlockwise order, `(k, 2)` [Nm]; none where the cut misses the set, two where
        it is a line.
    """
    normal, offset, reach = _cut(matrix, lower, upper, joints, held)
    points, _ = _vertices(normal, offset, reach)
    if len(points) < 3:
        return points
    around = points - points.mean(0)
    return points[np.argsort(np.arctan2(around[:, 1], around[:, 0]))]


def projection_polygon(
    matrix: np.ndarray, lower: np.ndarray, upper: np.ndarray, joints: tuple[int, int]
) -> np.ndarray:
    """Compute the torques that two joints can have together, whatever the others have.

    Args:
        matrix: M [-], `(joints, motors)`.
        lower: least motor torques [Nm], `(motors,)`.
        upper: largest motor torques [Nm], `(motors,)`.
        joints: the two joints.

    Returns:
        Vertices, anticlockwise, `(k, 2)` [Nm].
    """
    return slice_polygon(matrix, lower, upper, joints, {})


def slice_polyhedron(
    matrix: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    joints: tuple[int, int, int],
    held: Mapping[int, float] | None = None,
) -> Polyhedron:
    """Compute the torques that three joints can have together while others are held.

    Args:
        matrix: M [-], `(joints, motors)`.
        lower: least motor torques [Nm], `(motors,)`.
        upper: largest motor torques [Nm], `(motors,)`.
        joints: the three joints.
        held: torque of other joints by index [Nm], as in `slice_polygon`.

    Returns:
        Vertices and faces of the polyhedron.

    Raises:
        InfeasibleError: the cut misses the set or has no volume.
    """
    normal, offset, reach = _cut(matrix, lower, upper, joints, held)
    points, on = _vertices(normal, offset, reach)
    if len(points) < 4 or np.linalg.matrix_rank(points - points.mean(0), tol=_TOUCHES * reach) < 3:
        raise InfeasibleError(
            "zonotope: the held torques leave no volume to draw; hold other values, or none"
        )
    faces: dict[frozenset[int], np.ndarray] = {}
    for facet in range(len(normal)):
        corners = np.flatnonzero(on[:, facet])
        if len(corners) < 3 or frozenset(corners) in faces:
            continue
        outward = normal[facet] / np.linalg.norm(normal[facet])
        across = np.cross(outward, np.eye(3)[np.argmin(np.abs(outward))])
        spokes = points[corners] - points[corners].mean(0)
        angle = np.arctan2(spokes @ np.cross(outward, across), spokes @ across)
        faces[frozenset(corners)] = corners[np.argsort(angle)]
    return Polyhedron(points, tuple(faces.values()))


def _cut(
    matrix: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    joints: tuple[int, ...],
    held: Mapping[int, float] | None,
) -> tuple[np.ndarray, np.ndarray, float]:
    """Half-spaces of the cut, `(facets, shown)` and `(facets,)`, and the largest motor torque limit
    [Nm].
    """
    matrix = np.asarray(matrix, float)
    if matrix.ndim != 2:
        raise InputError("zonotope", "matrix", matrix.shape, "expects one set, (joints, motors)")
    if held is None:
        held = {row: 0.0 for row in range(len(matrix)) if row not in joints}
    rows = [*joints, *held]
    if len(set(rows)) < len(rows) or not set(rows) <= set(range(len(matrix))):
        raise InputError(
            "zonotope", "joints, held", rows, f"expects different rows below {len(matrix)}"
        )
    normal, offset = halfspaces(matrix[rows], lower, upper)
    real = np.any(normal != 0, -1)
    shown = len(joints)
    offset = offset - normal[:, shown:] @ np.fromiter(held.values(), float, len(held))
    return (
        normal[real, :shown],
        offset[real],
        float(np.max(np.maximum(np.abs(lower), np.abs(upper)))),
    )


def _vertices(
    normal: np.ndarray, offset: np.ndarray, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Corners of `normal . x <= offset`, `(k, d)`, and which facets each lies on, `(k, facets)`."""
    size = normal.shape[1]
    tolerance = _TOUCHES * max(reach, 1e-12)
    # facets parallel to the cut bound nothing in it, but may say that it is empty
    length = np.linalg.norm(normal, axis=1)
    bounding = length > 1e-12 * length.max()
    if np.any(offset[~bounding] < -tolerance):
        return np.zeros((0, size)), np.zeros((0, len(normal)), bool)
    chosen = np.array(list(combinations(np.flatnonzero(bounding), size)))
    systems = normal[chosen]
    unit = systems / np.linalg.norm(systems, axis=-1, keepdims=True)
    chosen = chosen[np.abs(np.linalg.det(unit)) > 1e-9]
    points = np.linalg.solve(normal[chosen], offset[chosen][..., None])[..., 0]
    inside = np.all(points @ normal.T <= offset + tolerance, -1)
    # one corner may be the meeting of more facets than it needs: keep it once
    vertices: list[np.ndarray] = []
    spread = _TOUCHES * max(1e-12, float(np.abs(points[inside]).max(initial=0.0))) * 10
    for point in points[inside]:
        if not any(np.abs(point - other).max() <= spread for other in vertices):
            vertices.append(point)
    corners = np.array(vertices).reshape(-1, size)
    on = np.abs(corners @ normal.T - offset) <= 10 * tolerance
    return corners, on & bounding


__all__ = ["Polyhedron", "projection_polygon", "slice_polygon", "slice_polyhedron"]
