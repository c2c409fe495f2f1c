"""Rows that are free of forces of the ground, against forces that were drawn by chance."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from hyperleg_design.gap.model import pads
from hyperleg_design.gap.signals.contact import Ground
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.unknown_forces import ALONG, eliminated

TICKS = 40
ALL, PLACE = "no force", "no place"


@pytest.fixture(scope="module")
def subject(biped_runs):
    return load_subject(None, [biped_runs["standing"]])


def ground(subject, unknown):
    """Contact of two feet of which a log tells as much as `unknown` says of each."""
    force = np.zeros((TICKS, len(subject.feet), 3))
    on_pads = np.zeros((TICKS, len(subject.pads), 3))
    touching = np.zeros((TICKS, len(subject.feet)), bool)
    for foot, kind in unknown.items():
        touching[:, foot] = True
        on_pads[:, subject.pad_foot == foot] = np.nan
        if kind == ALL:
            force[:, foot] = np.nan
    return Ground(subject, force, on_pads, touching)


def drawn(subject, unknown, seed):
    """A posture and forces on the pads of the feet, those of a foot whose force is known with a sum
    of zero: what a log does not tell.
    """
    rng = np.random.default_rng(seed)
    position = np.tile(rng.uniform(-0.3, 0.3, len(subject.joints)), (TICKS, 1))
    turned = Rotation.from_rotvec(0.2 * rng.standard_normal(3)).as_matrix()
    force = np.zeros((TICKS, len(subject.pads), 3))
    for foot, kind in unknown.items():
        own = subject.pad_foot == foot
        force[:, own] = rng.normal(0, [ALONG, ALONG, 1.0], (TICKS, own.sum(), 3))
        if kind == PLACE:
            force[:, own] -= force[:, own].mean(1, keepdims=True)
    return position, np.broadcast_to(turned, (TICKS, 3, 3)), force


@pytest.mark.parametrize(
    "unknown", [{0: ALL}, {1: PLACE}, {0: ALL, 1: ALL}, {0: PLACE, 1: PLACE}, {0: ALL, 1: PLACE}]
)
@pytest.mark.parametrize("seed", range(3))
def test_no_unknown_force_reaches_the_rows_that_are_judged(subject, unknown, seed):
    position, rotation, force = drawn(subject, unknown, seed)
    none = np.zeros(position.shape, bool)
    rows = eliminated(position, rotation, ground(subject, unknown), none, 2)
    assert rows.ticks.tolist() == list(range(TICKS))
    pushed, wrench = pads.contact_torque(subject, position, rotation, force)
    freed = rows.applied(-pushed, -wrench)
    freed[rows.lost] = 0.0
    assert (~rows.lost).sum() >= 6 * TICKS
    # a moment about the normal of the floor is left where it moves all joints little
    assert np.abs(freed).max() < 0.1 * np.abs(pushed).max()
    if len(unknown) == 1:
        np.testing.assert_allclose(freed, 0.0, atol=1e-9)


def test_rows_of_joints_that_no_unknown_force_reaches_stay_as_they_are(subject):
    position, rotation, _ = drawn(subject, {0: ALL}, 5)
    none = np.zeros(position.shape, bool)
    rows = eliminated(position, rotation, ground(subject, {0: ALL}), none, 2)
    motion = np.random.default_rng(1).standard_normal(position.shape)
    other = [i for i, j in enumerate(subject.joints) if j.startswith("right")]
    base = np.ones((TICKS, 6))
    np.testing.assert_array_equal(rows.applied(motion, base)[:, other], motion[:, other])
    traces = rows.freed({"base": base[None], "drive": motion[None]})
    np.testing.assert_array_equal(traces["motion"][0], rows.applied(0 * motion, base))
    assert traces["drive"] is not None


def test_noise_of_independent_joints_is_independent_in_the_rows_that_are_judged(subject):
    unknown = {0: ALL, 1: ALL}
    position, rotation, _ = drawn(subject, unknown, 4)
    none = np.zeros(position.shape, bool)
    rows = eliminated(position, rotation, ground(subject, unknown), none, 2)
    weights = rows.of_joints[0][~rows.lost[0]]
    np.testing.assert_allclose(weights @ weights.T, np.eye(len(weights)), atol=1e-9)


def test_a_row_that_needs_an_unmeasured_joint_is_lost(subject):
    unknown = {0: PLACE, 1: PLACE}
    position, rotation, _ = drawn(subject, unknown, 3)
    none = np.zeros(position.shape, bool)
    rows = eliminated(position, rotation, ground(subject, unknown), none, 2)
    used = np.abs(rows.of_joints[0] - np.diag(np.diag(rows.of_joints[0])))
    spent = int(np.argmax(used.sum(0)))
    missing = none.copy()
    missing[:, spent] = True
    without = eliminated(position, rotation, ground(subject, unknown), missing, 2)
    assert without.lost[:, used[:, spent] > 1e-2].all()


def test_what_the_ground_tells_of_changes_soon_is_left_out(subject):
    position, rotation, _ = drawn(subject, {0: ALL}, 0)
    known = ground(subject, {0: ALL})
    known.touching[: TICKS // 2], known.pad_force[: TICKS // 2] = False, 0.0
    none = np.zeros(position.shape, bool)
    rows = eliminated(position, rotation, known, none, 4)
    assert rows.ticks.tolist() == list(range(TICKS // 2 + 4, TICKS))


def test_known_forces_need_no_elimination(subject):
    position, rotation, _ = drawn(subject, {}, 0)
    none = np.zeros(position.shape, bool)
    assert eliminated(position, rotation, ground(subject, {}), none, 2) is None
