"""Forces of the ground that nobody measured, eliminated from the equations of motion.

Where feet touch and a log does not tell the force on a foot, or not where under the foot it acts,
the ground pushes with generalised forces A w that are unknown in size alone: w are forces on
points, and wrenches on feet with more than one pad. With the residuals r of the floating base and
the joints,

    r_joints - A_joints A_base^+ r_base

is free of all w that the base feels: of the whole wrench on a foot that stands alone. What is left,
L w with L = A_joints (1 - A_base^+ A_base), are feet that push against each other. As many joints
are spent on it as L has independent rows. With the projection P across the columns of L and the
joints k that are left,

    P_kk^(-1/2) P_k

makes rows that are free of w, as near to those of the joints k as rows can be whose noise is
independent. What moves all joints little (a foot that turns on the spot, where no joint turns with
it) is left in.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.model.frames import joint_frames
from hyperleg_design.gap.model.pads import joint_lever, pad_points
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.contact import Ground, widened

WEAK = 0.1
"""Torque of an unknown force at a joint, over the largest at any joint, from which it is eliminated
[-] (assumed: torques of that size are left where masses are off by some per cent)."""
ALONG = 0.3
"""Force along the ground, and moment about its normal, over those across it, as is usual [-]
(assumed)."""
SHARE = 0.1
"""Share of another joint's residual in a row from which its rest is that of the row [-]
(assumed)."""
LARGE = 0.9
"""Torque of an unknown force at a joint, over the largest, from which the joint may be spent on it
[-] (developed: at 0.5 noise is twice as large, and dry friction of a calf is lost in it)."""
FREE = 0.05
"""Least share of a combination of rows, squared, that unknown forces leave free [-] (assumed)."""
SINGULAR = 1e-3
"""Singular value over the largest, below which the base does not feel a force, and share of a row
below which it is none [-] (numerical)."""

NO_FORCE, NO_PLACE = 1, 2
"""What nobody measured of a foot: the force on it, or only where it acts."""


@dataclass(frozen=True, eq=False)
class Elimination:
    """Combinations of rows that are free of unknown forces, at u of t ticks."""

    ticks: np.ndarray
    """`(u,)`."""
    of_joints: np.ndarray
    """Weights of the joints' rows `(u, n, n)`."""
    of_base: np.ndarray
    """Weights of the base's rows `(u, n, 6)`."""
    lost: np.ndarray
    """Rows that are spent, or not free of unknown forces `(u, n)` of bool."""

    def applied(self, motion: np.ndarray, base: np.ndarray | None) -> np.ndarray:
        """Combine the rows of residuals or traces.

        Args:
            motion: rows of the joints `(..., t, n)` [Nm].
            base: rows of the base `(..., t, 6)` [N, Nm]; None where they are zero.

        Returns:
            Rows of the joints `(..., t, n)`.
        """
        rows = np.array(motion, float)
        own = np.nan_to_num(rows[..., self.ticks, :])
        freed = self.of_joints @ own[..., None]
        if base is not None:
            freed += self.of_base @ np.nan_to_num(base[..., self.ticks, :])[..., None]
        rows[..., self.ticks, :] = freed[..., 0]
        return rows

    def note(self, joints: Sequence[str]) -> str:
        """Say what is not judged.

        Args:
            joints: names of all joints.
        """
        spent = self.lost.mean(0) > 0.5
        names = ", ".join(name for name, own in zip(joints, spent, strict=True) if own)
        eliminated = (
            "forces of the ground that are not logged, or not where they act, are eliminated"
        )
        return eliminated + (
            f": {names} tell them, and their faults show elsewhere" if names else ""
        )

    def pushed(self, base: np.ndarray | None, ticks: int) -> np.ndarray:
        """Estimate what unknown forces give the joints, from what the base needs.

        Args:
            base: rows of the base `(t, 6)` [N, Nm]; None of a fixed base.
            ticks: number t of ticks.

        Returns:
            `(t, n)` [Nm]; 0 where all forces are known.
        """
        torque = np.zeros((ticks, self.lost.shape[1]))
        if base is not None:
            torque[self.ticks] = (self.of_base @ base[self.ticks][..., None])[..., 0]
        return torque

    def anywhere(self, joints: np.ndarray) -> np.ndarray:
        """Tell in which rows there are joints of some kind.

        Args:
            joints: `(t, n)` of bool.

        Returns:
            Rows of such joints, or with a share of one `(t, n)`.
        """
        rows = joints.copy()
        shares = np.abs(self.of_joints) > SHARE
        rows[self.ticks] = (shares & joints[self.ticks][:, None]).any(-1)
        return rows

    def freed(self, traces: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Combine the rows of traces as those of the residual.

        Args:
            traces: by residual `(..., t, rows)`, physical.

        Returns:
            The same, with `motion` as the residual shows it.
        """
        base = traces.get("base")
        motion = traces.get("motion")
        if motion is None:
            if base is None:
                return dict(traces)
            motion = np.zeros((*base.shape[:-1], self.lost.shape[1]))
        return {**traces, "motion": self.applied(motion, base)}


def eliminated(
    position: np.ndarray,
    rotation: np.ndarray | None,
    ground: Ground,
    unmeasured: np.ndarray,
    margin: int,
) -> Elimination | None:
    """Find combinations of rows that are free of unknown forces.

    Args:
        position: of the joints `(t, n)` [rad].
        rotation: world from base `(t, 3, 3)`; None of a fixed base.
        ground: contact of the log.
        unmeasured: joints whose torque or motion nobody measured `(t, n)`.
        margin: ticks around a change of what is unknown, which are left out.

    Returns:
        The combinations; None where all forces are known.
    """
    subject, (no_force, no_place) = ground.subject, ground.unknown
    kinds = NO_FORCE * no_force + NO_PLACE * no_place
    depth = np.array([len(subject.tree.chain(joint)) for joint in range(subject.tree.count)])
    parts = []
    for kind, ticks in _stances(kinds, margin) if kinds.any() else ():
        upright = None if rotation is None else rotation[ticks]
        pushes, inside = _pushes(subject, position[ticks], upright, kind)
        parts.append((ticks, *_combined(pushes, inside, depth, rotation is not None)))
    if not parts:
        return None
    ticks, of_joints, of_base, lost = (
        np.concatenate(column) for column in zip(*parts, strict=True)
    )
    order = np.argsort(ticks)
    ticks, of_joints, of_base, lost = ticks[order], of_joints[order], of_base[order], lost[order]
    lost |= ((np.abs(of_joints) > SINGULAR) & unmeasured[ticks][:, None]).any(-1)
    return Elimination(ticks, of_joints, of_base, lost)


def _stances(kinds: np.ndarray, margin: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """What is unknown of each foot `(f,)`, and the ticks where that holds and does not change
    soon.
    """
    near = widened(np.append((kinds[1:] != kinds[:-1]).any(1), False), margin)
    for kind in np.unique(kinds, axis=0):
        ticks = np.flatnonzero((kinds == kind).all(1) & ~near)
        if kind.any() and len(ticks):
            yield kind, ticks


def _pushes(
    subject: Subject, position: np.ndarray, rotation: np.ndarray | None, kind: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Generalised forces of unit unknown forces, base first `(t, 6 + n, u)`, each in a size that is
    usual; and joints within a foot that are unknown in any case `(n,)`.
    """
    tree, count = subject.tree, len(position)
    upright = np.broadcast_to(np.eye(3), (count, 3, 3)) if rotation is None else rotation
    from_world = np.swapaxes(upright, -1, -2)
    frames, points = joint_frames(tree, position), pad_points(subject, position, upright)
    columns, inside = [], np.zeros(tree.count, bool)
    for foot in np.flatnonzero(kind).tolist():
        own = np.flatnonzero(subject.pad_foot == foot)
        chains = [set(tree.chain_to(subject.pads[pad].link)) for pad in own]
        chain = sorted(set.intersection(*chains))
        inside[sorted(set.union(*chains) - set(chain))] = True
        at = points[:, own].mean(1)
        force, moment = np.zeros((2, count, 6 + tree.count, 3))
        force[:, :3] = moment[:, 3:6] = np.eye(3)
        force[:, 3:6] = -np.cross(at[:, None], np.eye(3))
        for j in chain:
            force[:, 6 + j] = joint_lever(tree, frames, j, at)
            moment[:, 6 + j] = tree.hinge[j] * frames[j][0][..., 2]
        if kind[foot] == NO_FORCE:
            columns.append(force @ (from_world * [ALONG, ALONG, 1.0]))
        if len(own) > 1:
            reach = float(np.linalg.norm(points[:, own] - at[:, None], axis=-1).max())
            columns.append(moment @ (from_world * [reach, reach, ALONG * reach]))
    return np.concatenate(columns, -1), inside


def _combined(
    columns: np.ndarray, inside: np.ndarray, depth: np.ndarray, floating: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Weights of the joints' rows and of the base's, and rows that are lost."""
    count, joints = len(columns), columns.shape[1] - 6
    base, own = columns[:, :6] * floating, columns[:, 6:]
    from_base = np.linalg.pinv(base, rcond=SINGULAR)
    of_base = -own @ from_base
    left = own + of_base @ base
    size = float(np.sqrt(np.mean(np.sum(own**2, -1), axis=0).max()))
    spent = _spent(left, WEAK * size, depth)
    of_joints = np.broadcast_to(np.eye(joints), (count, joints, joints)).copy()
    lost = np.broadcast_to(inside, (count, joints)).copy()
    if len(spent):
        rest = np.setdiff1d(np.arange(joints), spent)
        across = np.linalg.svd(left, full_matrices=False)[0][..., : len(spent)]
        free = np.eye(joints) - across @ np.swapaxes(across, -1, -2)
        square, turn = np.linalg.eigh(free[:, rest][:, :, rest])
        root = (turn / np.sqrt(np.maximum(square, SINGULAR))[:, None]) @ np.swapaxes(turn, -1, -2)
        of_joints[:, rest] = root @ free[:, rest]
        of_joints[:, spent] = 0.0
        lost |= (square < FREE).any(-1, keepdims=True)
        lost[:, spent] = True
        left = of_joints @ left
    lost |= np.linalg.norm(left, axis=-1) > WEAK * size
    return of_joints, of_joints @ of_base, lost


def _spent(left: np.ndarray, least: float, depth: np.ndarray) -> list[int]:
    """Joints whose rows tell unknown forces that the base does not, down to the least torque of
    such a force: by Cholesky's method with pivots, of which the one farthest from the base is taken
    that is not much smaller than the largest. So it is the same in every log.
    """
    gram = np.einsum("tiu,tju->ij", left, left) / len(left)
    spent: list[int] = []
    while len(spent) < min(left.shape[1:]):
        size = np.diag(gram)
        if size.max() <= least**2:
            break
        large = np.flatnonzero(size >= LARGE**2 * size.max())
        joint = int(large[np.argmax(depth[large] + SINGULAR * large)])
        gram = gram - np.outer(gram[:, joint], gram[joint]) / size[joint]
        spent.append(joint)
    return spent
