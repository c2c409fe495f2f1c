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


@pytest.mark.parametrize("name", ["payload", "link_com"])
@pytest.mark.parametrize("values", [[1.2, 0.08, -0.06, 0.1, 0.0], [1.2, -0.05, 0.07, 0.02, 0.0]])
def test_values_with_a_mass_and_moment_are_found_from_their_sum(name, values, arm):
    one, link = effect(name), "forearm"
    truth = np.array([values if name == "payload" else values[1:4]])
    weights = one.in_span(link, arm.subject, truth)[0]
    np.testing.assert_allclose(one.nearest(link, arm.subject, weights)[0], truth[0], atol=1e-9)


def test_a_moment_whose_mass_no_motion_tells_is_that_of_a_load_at_its_usual_place(arm):
    one, link = effect("payload"), "forearm"
    usual = one.example(link, arm.subject)
    weights = one.in_span(link, arm.subject, usual[None])[0] * ([0.01] + [1.0] * 9)
    second = one.nearest(link, arm.subject, weights)[1]
    np.testing.assert_allclose(second, usual, atol=1e-9)


def test_without_any_mass_or_moment_no_start_is_left(arm):
    for name in ("payload", "link_com"):
        nearest = effect(name).nearest("forearm", arm.subject, np.zeros(10))
        assert effect(name).in_span("forearm", arm.subject, nearest).shape == (0, 10)


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
    assert effect("link_mass").bounds("forearm", arm.subject)[0, 0] == pytest.approx(-0.99 * 2.3)
    assert effect("payload").bounds("forearm", arm.subject)[0, 0] == pytest.approx(-0.99 * 2.3)
    assert effect("payload").bounds("flange", arm.subject)[0, 0] == 0.0


def test_without_a_residual_the_usual_starts_are_left(arm):
    for name in ("payload", "link_com"):
        still = replace(
            arm, residual=arm.residual | {"motion": np.full_like(arm.residual["motion"], np.nan)}
        )
        assert len(effect(name).starts(still, "forearm")) == (2 if name == "payload" else 6)
