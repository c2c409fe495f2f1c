"""How models predict data that they were not fitted to: the measure by which causes are named."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from hyperleg_design.gap.inference.base import Base, number_of
from hyperleg_design.gap.inference.fit import ROUNDS, Design, Fit
from hyperleg_design.gap.inference.samples import BLOCKS

FREEDOM = 40.0
"""Most degrees of freedom of a predictive distribution: the scale of other data is never known
better (assumed)."""


AT_ONCE = 20_000
"""Samples whose doubt is computed at once, for memory's sake."""
_DOUBTS: WeakKeyDictionary[Base, dict[int, np.ndarray]] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class Held:
    """How a model predicts data that it was not fitted to."""

    likelihood: np.ndarray
    """Log-likelihood by block of the bootstrap `(B,)`."""
    square: np.ndarray
    """Sum of the squares that are left, by block and group, in the residual's unit `(B, G)`."""
    left: np.ndarray
    """What is left of every sample, weighted `(S,)`."""
    over: float
    """Log-likelihood of all blocks had no group less noise than its floor: what models tell of less
    than the floor does not count.

    Nor does what causes that scale torques have of it (`endogenous`), which shrinks noise however
    small.
    """
    bare: np.ndarray
    """As `square`, had the causes not been there: the same nuisance parameters, without the causes'
    traces `(B, G)`."""

    @property
    def total(self) -> float:
        """Log-likelihood of all blocks."""
        return float(self.likelihood.sum())


def predict(design: Design, way: int = BLOCKS, fit: Fit | None = None) -> Held:
    """Fit without each fold and predict it.

    Args:
        design: columns of the model.
        way: of holding out.
        fit: to all data: scales to begin with, and where causes are linearised.
    """
    start = None if fit is None else fit.scale
    if fit is not None:
        design.trust(fit)
    base = design.base
    samples = base.samples
    left, spread, freedom = (
        np.zeros(len(samples.value)),
        np.ones(len(samples.value)),
        np.ones(len(samples.value)),
    )
    bare, open_to = np.zeros(len(samples.value)), doubt(base, way)
    scaled, faint = [], []
    fold_of = samples.fold[way][samples.part]
    for fold in range(samples.folds(way)):
        found = design.fit(way, fold, start, rounds=ROUNDS if start is None else 2)
        errors = found.errors
        scaled.append(design.scaled(found.phi))
        faint.append(design.scaled(found.phi, found.scale))
        # a session that was held out whole has no fit of its own: its errors stay at the prior mean
        here = fold_of == fold
        rest, trace = design.left(found.phi, errors), design.trace(found.phi)
        left[here], bare[here] = rest[here], (rest + trace)[here]
        spread[here] = found.scale[samples.group[here]]
        freedom[here] = np.minimum(base.freedom + number_of(base, way, fold, False), FREEDOM)[
            samples.group[here]
        ]
    cell = samples.block * samples.groups + samples.group
    cells, inverse = np.unique(cell, return_inverse=True)
    size = np.bincount(inverse, samples.share)
    square = np.bincount(inverse, left**2 / (1 + open_to / spread))
    nu, scale = (np.bincount(inverse, v * samples.share) / size for v in (freedom, spread))
    likelihood = np.bincount(
        cells // samples.groups, _student(square, size, nu, scale), base.blocks
    )
    over = float(_student(square, size, nu, np.maximum(scale, 1.0)).sum())
    for fold in range(samples.folds(way) if design.factors else 0):
        share = np.bincount(samples.block, samples.share * (fold_of == fold), base.blocks)
        likelihood = likelihood + scaled[fold] * share / samples.share.sum()
        over += faint[fold] * float(share.sum() / samples.share.sum())
    squares, whole = (
        np.bincount(cell, (v / samples.weight) ** 2, base.blocks * samples.groups).reshape(
            base.blocks, samples.groups
        )
        for v in (left, bare)
    )
    return Held(likelihood, squares, left, over, whole)


def untold(design: Design, fit: Fit, way: int = BLOCKS) -> np.ndarray:
    """How far the other folds leave the causes' trace in each fold open: standard deviation over
    the trace, root mean squares `(folds,)`.

    Args:
        design: columns of the model.
        fit: to all data, whose trace it is.
        way: of holding out.
    """
    samples, own = design.base.samples, design.columns[: design.count]
    fold_of, trace = samples.fold[way][samples.part], design.trace(fit.phi)
    found = np.zeros(samples.folds(way))
    for fold in range(len(found)):
        here = fold_of == fold
        known = design.fit(way, fold, fit.scale, rounds=2).covariance
        doubtful = float(np.einsum("ks,kl,ls->", own[:, here], known, own[:, here], optimize=True))
        found[fold] = np.sqrt(doubtful / max(float(np.sum(trace[here] ** 2)), 1e-12))
    return found


def _student(square: np.ndarray, size: np.ndarray, nu: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Log density of cells of `size` numbers whose squares sum up to `square`, of a t-distribution
    of `nu` and `scale`; each `(cells,)`.
    """
    return np.asarray(
        -0.5 * (nu + size) * np.log1p(square / (nu * scale)) - 0.5 * size * np.log(scale)
    )


def doubt(base: Base, way: int = BLOCKS) -> np.ndarray:
    """How far the nuisance parameters of the other folds leave each sample open, without any cause:
    variance over the floor's `(S,)`.

    A joint that hardly slides in any other block is foretold by the usual size of its errors alone.
    Kept while the base lives.
    """
    kept = _DOUBTS.setdefault(base, {})
    if way not in kept:
        samples, design = base.samples, Design(base)
        scale = design.fit().scale
        found = np.zeros(len(samples.value))
        fold_of, session_of = samples.fold[way][samples.part], samples.session[samples.part]
        for fold in range(samples.folds(way)):
            weight = 1 / np.minimum(
                design.fit(way, fold, scale, rounds=2).scale, 1.0
            )  # a gap does not make the other blocks tell less
            for session in range(samples.sessions):
                here = np.flatnonzero((fold_of == fold) & (session_of == session))
                if not here.size:
                    continue
                known = np.linalg.inv(
                    base.part(way, fold, session, False).weighed(weight)[:-1, :-1]
                    + base.prior.precision
                )
                for start in range(0, here.size, AT_ONCE):
                    part = here[start : start + AT_ONCE]
                    mine = base.errors[:, part]
                    found[part] = np.einsum("ps,ps->s", mine, known @ mine)
        kept[way] = found / samples.share
    return kept[way]
