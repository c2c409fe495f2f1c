"""Masses: what the trace says is what inverse dynamics of the changed model says, in MuJoCo and in
Pinocchio.
"""

from __future__ import annotations

import copy
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from pinocchio_tree import pinocchio_model

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.links.inertial import carried_mass
from hyperleg_design.gap.effects.links.payload import FAR, NEAR
from hyperleg_design.gap.model.mechanism import mechanism_of
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.simulation.alteration import edited

VALUES = {
    "payload": [0.7, 0.03, -0.05, 0.12, 0.004],
    "link_mass": [0.4],
    "link_com": [0.02, -0.01, 0.03],
}


@pytest.fixture(scope="module")
def arm(robot_files, runs):
    log = runs["arm"]
    return condition(log, load_subject(robot_files["arm"], [log]))


def in_mujoco(model, signals, ticks):
    """Joint torques that a motion needs in MuJoCo, without what is no rigid body `(t, n)`."""
    data = mujoco.MjData(model)
    model = copy.copy(model)
    model.dof_damping[:] = 0
    found = []
    for tick in ticks:
        data.qpos[:], data.qvel[:], data.qacc[:] = (
            signals.position[tick],
            signals.velocity[tick],
            signals.acceleration[tick],
        )
        mujoco.mj_inverse(model, data)
        found.append(data.qfrc_inverse.copy())
    return np.array(found)


@pytest.mark.parametrize("name", VALUES)
@pytest.mark.parametrize("link", ["upper_arm", "forearm", "wrist_3_link"])
def test_trace_is_the_difference_of_inverse_dynamics(name, link, arm):
    one, values, ticks = effect(name), np.array(VALUES[name]), np.arange(100, 1900, 90)
    trace = one.trace(arm, link, np.stack([one.nulls, values]))["motion"][:, ticks]
    assert not trace[0].any()
    changed = edited(arm.subject.model, (one.alteration(link, values, arm.subject),))
    expected = in_mujoco(changed, arm, ticks) - in_mujoco(arm.subject.model, arm, ticks)
    np.testing.assert_allclose(trace[1], expected, atol=2e-8 * np.abs(expected).max() + 1e-9)
    assert np.abs(expected).max() > 0.1
    import pinocchio

    needs = []
    for model in (changed, arm.subject.model):
        rigid = pinocchio_model(mechanism_of(model), arm.subject.gravity)
        rigid.armature[:] = 0
        needs.append(
            [
                pinocchio.rnea(
                    rigid, rigid.createData(), arm.position[t], arm.velocity[t], arm.acceleration[t]
                )
                for t in ticks
            ]
        )
    np.testing.assert_allclose(
        trace[1], np.array(needs[0]) - np.array(needs[1]), atol=1e-7 * np.abs(expected).max() + 1e-9
    )


@pytest.mark.parametrize("name", VALUES)
def test_rows_of_joints_beyond_the_link_are_untouched(name, arm):
    trace = effect(name).trace(arm, "forearm", np.array([VALUES[name]]))["motion"][0]
    elbow = arm.subject.joints.index("elbow")
    assert np.abs(trace[:, : elbow + 1]).max(0).min() > 1e-3
    assert not trace[:, elbow + 1 :].any()


def test_a_payload_weighs_what_it_weighs(arm):
    model = arm.subject.model
    changed = edited(
        model,
        (effect("payload").alteration("wrist_3", np.array([2.5, 0, 0.02, 0.1, 0]), arm.subject),),
    )
    body = model.body("wrist_3_link").id
    assert changed.body_mass[body] - model.body_mass[body] == pytest.approx(2.5)
    moments = [m.body_mass[body] * m.body_ipos[body] for m in (changed, model)]
    np.testing.assert_allclose(moments[0] - moments[1], 2.5 * np.array([0, 0.02, 0.1]), atol=1e-12)


def test_simulations_have_their_own_rows(arm):
    values = np.array([[0.0, 0, 0, 0, 0], [1.0, 0, 0, 0.1, 0.002]])
    added = effect("payload").alteration("forearm", values, arm.subject)
    model = arm.subject.model
    body = model.body("forearm").id
    masses = [edited(model, (added,), k).body_mass[body] - model.body_mass[body] for k in (0, 1)]
    assert masses == pytest.approx([0.0, 1.0])


def test_inertia_stays_that_of_a_body(arm):
    values = np.array([1.0, 0.3, -0.2, 0.1, 0.01])
    changed = edited(
        arm.subject.model, (effect("payload").alteration("forearm", values, arm.subject),)
    )
    inertia = changed.body_inertia[changed.body("forearm").id]
    assert np.all(inertia > 0)
    assert inertia.max() <= inertia.sum() - inertia.max() + 1e-12


def test_more_than_all_of_a_link_cannot_go(arm):
    for name, values in (("payload", [-3.0, 0, 0, 0, 0]), ("link_mass", [-3.0])):
        with pytest.raises(InputError, match=r"takes more than the 2\.3 kg"):
            effect(name).alteration("forearm", np.array(values), arm.subject)


def test_places_are_one_for_each_body_that_moves(arm):
    assert effect("payload").locations(arm.subject)[:3] == ("shoulder", "upper_arm", "forearm")
    assert "flange" not in effect("payload").locations(arm.subject)
    assert effect("payload").place("flange", arm.subject) == "flange"
    assert effect("payload").place("wrist_3", arm.subject) == "wrist_3_link"
    assert "flange" not in effect("link_mass").locations(arm.subject)


def test_usual_masses_follow_the_robot(arm):
    assert carried_mass(arm.subject, "upper_arm") == pytest.approx(8.4 + 2.3 + 1.2 + 1.2 + 0.19)
    assert effect("payload").usual("upper_arm", arm.subject)[0] == pytest.approx(
        0.2 * carried_mass(arm.subject, "upper_arm")
    )
    assert effect("link_mass").usual("forearm", arm.subject)[0] == pytest.approx(0.23)
    assert effect("payload").example("forearm", arm.subject)[3] == pytest.approx(1.5 * 0.196)


def test_a_linear_fit_finds_a_payload_that_hangs_there(arm):
    import dataclasses

    values = np.array([2.0, 0.05, -0.02, 0.15, 0.0])
    one = effect("payload")
    residual = {
        **arm.residual,
        "motion": arm.residual["motion"]
        + one.trace(arm, "wrist_1_link", values[None])["motion"][0],
    }
    loaded = dataclasses.replace(arm, residual=residual)
    start = one.starts(loaded, "wrist_1_link")[0]
    assert start[0] == pytest.approx(2.0, rel=0.15)
    np.testing.assert_allclose(start[1:], values[1:], atol=0.05)


def test_a_linear_fit_finds_a_payload_on_a_floating_base(biped_runs):
    """No joint feels it directly; the ground must give more."""
    log, one = biped_runs["standing"], effect("payload")
    standing = condition(log, load_subject(None, [log]))
    base = one.locations(standing.subject)[0]
    values = np.array([3.0, 0.06, -0.04, 0.1, 0.0])
    trace = one.trace(standing, base, values[None])
    residual = standing.residual | {"base": trace["base"][0]}
    start = one.starts(replace(standing, residual=residual), base)[0]
    assert start[0] == pytest.approx(3.0, rel=0.05)
    np.testing.assert_allclose(start[1:3], values[1:3], atol=0.02)
    told = {name: rows for name, rows in standing.residual.items() if name != "base"}
    assert len(one.starts(replace(standing, residual=told), base)) == 2


def test_a_load_out_of_its_links_reach_is_rather_none(arm):
    one, reach = effect("payload"), NEAR * arm.subject.tree.length
    assert reach == pytest.approx(NEAR * sum(np.linalg.norm(arm.subject.tree.offset[1:], axis=1)))
    for away, own, likely in (
        (0.9 * reach, 0.0, True),
        (1.1 * reach, 0.0, False),
        (0.9 * reach, reach, False),
    ):
        values = np.array([0.5, 0.0, 0.0, away, own**2])
        assert one.odds("wrist_3_link", arm.subject, values) == (0.0 if likely else -FAR)


def test_bounds_leave_something_of_a_link(arm):
    assert effect("link_mass").bounds("forearm", arm.subject)[0, 0] == pytest.approx(-0.95 * 2.3)
    assert effect("payload").bounds("forearm", arm.subject)[0, 0] == pytest.approx(-0.95 * 2.3)
    assert effect("payload").bounds("flange", arm.subject)[0, 0] == 0.0


@pytest.mark.parametrize("name", ["payload", "link_com"])
@pytest.mark.parametrize("values", [[1.2, 0.08, -0.06, 0.1, 0.0], [1.2, -0.05, 0.07, 0.02, 0.0]])
def test_a_start_is_near_what_is_there_wherever_it_lies(name, values, arm):
    one, link = effect(name), "forearm"
    truth = np.array(values if name == "payload" else values[1:4])
    wrong = replace(
        arm, residual=arm.residual | {"motion": one.trace(arm, link, truth[None])["motion"][0]}
    )
    first = one.starts(wrong, link)[0]
    there, found = one.trace(arm, link, np.stack([truth, first]))["motion"]
    assert np.square(there - found).mean() < 0.05 * np.square(there).mean()


def test_without_a_residual_the_usual_starts_are_left(arm):
    for name in ("payload", "link_com"):
        still = replace(
            arm, residual=arm.residual | {"motion": np.full_like(arm.residual["motion"], np.nan)}
        )
        assert len(effect(name).starts(still, "forearm")) == (2 if name == "payload" else 6)
