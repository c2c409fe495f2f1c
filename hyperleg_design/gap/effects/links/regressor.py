"""Joint torques and base wrenches over the inertial parameters of a link, at a log's motion."""

from __future__ import annotations

import threading
from weakref import WeakKeyDictionary

import numpy as np

from hyperleg_design.gap.model.inertial_regressor import regressors
from hyperleg_design.gap.signals.signals import Signals

_REGRESSORS: WeakKeyDictionary[Signals, dict[str, np.ndarray]] = WeakKeyDictionary()
_LOCK = threading.Lock()
KEPT = 512 * 2**20
"""Memory that kept regressors may take in all [bytes]; beyond it the oldest are forgotten."""


def link_regressor(signals: Signals, link: str) -> np.ndarray:
    """Compute the joint torque over the inertial parameters of one link, at the logged motion.

    The columns are mass, mass times centre of mass (3), and inertia about the link's origin (xx,
    xy, yy, xz, yz, zz), in the link's frame. Torque is linear in them: what hangs on a link adds
    `link_regressor @ parameters`. The result is kept while `signals` live and memory lasts.

    Args:
        signals: conditioned log.
        link: name of the link, or of the joint that carries it.

    Returns:
        The regressor, `(t, n, 10)`, read-only.

    Raises:
        InputError: no such link or joint.
    """
    with _LOCK:
        regressor = _REGRESSORS.setdefault(signals, {}).get(link)
    if regressor is None:
        regressor = _regressors(signals, link)[0]
        regressor.setflags(write=False)
        with _LOCK:
            _forget(KEPT - regressor.nbytes)
            _REGRESSORS.setdefault(signals, {})[link] = regressor
    return regressor


def _forget(room: int) -> None:
    """Drop the oldest kept regressors until the others take no more than some room [bytes]."""
    total = sum(r.nbytes for each in _REGRESSORS.values() for r in each.values())
    for each in list(_REGRESSORS.values()):
        while each and total > room:
            total -= each.pop(next(iter(each))).nbytes


def base_regressor(signals: Signals, link: str) -> np.ndarray:
    """Compute the wrench that the floating base needs over the inertial parameters of one link.

    Args:
        signals: conditioned log of a floating base.
        link: name of the link.

    Returns:
        The regressor, `(t, 6, 10)`; its columns are those of `link_regressor`.
    """
    assert signals.base is not None
    return _regressors(signals, link)[1]


def _regressors(signals: Signals, link: str) -> tuple[np.ndarray, np.ndarray]:
    motion = signals.position, signals.velocity, signals.acceleration, signals.base
    return regressors(signals.subject, *motion, link)
