"""The residual of the ground, on a biped that stands, bends its knees and presses its feet apart in
MuJoCo.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.ground_friction import ChangedGround
from hyperleg_design.gap.playback import show, standard_run
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.ground import (
    floor_geoms,
    foot_bodies,
    foot_geoms,
    footings,
    ground_residual,
    nominal_ground,
    pair_settings,
)
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.simulation.alteration import edited


@pytest.fixture(scope="module")
def biped():
    return show._subject(None, True)


@pytest.fixture(scope="module")
def standing(biped):
    """Signals of a run with alterations of the ground."""
    time = np.arange(601) * standard_run.TICK
    target = show._stand_targets(biped, time)
    kept = {}

    def signals(**changes):
        key = tuple(sorted(changes.items()))
        if key not in kept:
            alterations = (ChangedGround(foot_bodies(biped, 0), **changes),) if changes else ()
            kept[key] = condition(
                standard_run.simulated_log(biped, target, time, alterations)[1], biped
            )
        return kept[key]

    return signals


def rms(values):
    return float(np.sqrt(np.nanmean(values**2)))


def late(signals, values):
    """After the robot has come down."""
    return values[(signals.time > 0.6) & signals.valid]


def test_the_nominal_ground_explains_a_nominal_log(biped, standing):
    signals = standing()
    residual = late(signals, signals.residual["ground"])
    assert residual.shape[1] == 6
    weight = float(biped.model.body_subtreemass[1]) * 9.81
    assert rms(residual[:, [0, 1, 3, 4]]) < 0.01 * weight
    assert rms(residual[:, [2, 5]]) < 0.1 * weight / 2  # MuJoCo's contacts resist acceleration too
    assert np.nansum(late(signals, signals.contact)[..., 2].mean(0)) == pytest.approx(
        weight, rel=0.03
    )


def test_a_slippery_foot_leaves_what_the_trace_says(standing):
    signals = standing(friction=0.2)
    trace = effect("ground_friction").trace(signals, "left_foot", np.array([[1.0], [0.2]]))[
        "ground"
    ]
    assert np.nanmax(np.abs(trace[0])) < 1e-9
    residual, expected = (
        late(signals, signals.residual["ground"][:, :2]),
        late(signals, trace[1][:, :2]),
    )
    assert rms(residual) > 30.0
    assert rms(residual - expected) < 0.2 * rms(residual)
    assert np.nanmax(np.abs(trace[1][:, 3:])) < 1e-9


def test_what_creeps_or_lands_does_not_slide(biped, standing):
    """Feet of a simulated walk move at 0.05-0.25 m/s under load, with a tenth of the cone: no
    friction is that small.
    """
    foot = footings(standing())[0]
    one = np.ones(1)
    ticks = foot.settled & (foot.force[:, 2] > 100)

    def left(speed):
        moved = dataclasses.replace(
            foot, slide=np.tile([speed, 0.0], (len(foot.force), 1)), known={}
        )
        return rms((foot.force - moved.ground(one, one, one)[0])[ticks, :2])

    creeping = foot.friction * float(np.nanmax(foot.force[:, 2])) / foot.law.creep
    assert left(0.4 * creeping) < 1.0
    assert left(1.1 * creeping) > 30.0


def test_a_soft_foot_leaves_what_the_trace_says(standing):
    signals = standing(compliance=3.0)
    one = effect("ground_compliance")
    trace = one.trace(signals, "left_foot", np.array([[3.0, 1.0], [1.0, 1.0]]))["ground"]
    residual, expected = (
        late(signals, signals.residual["ground"][:, 2]),
        late(signals, trace[0][:, 2]),
    )
    assert rms(residual) > 2 * rms(late(standing(), standing().residual["ground"][:, 2]))
    assert rms(residual - expected) < 0.5 * rms(residual)
    assert np.nanmax(np.abs(trace[1])) < 1e-9


def test_edits_scale_the_contact_and_leave_the_other_foot(biped):
    changed = edited(
        biped.model, (effect("ground_friction").alteration("left_foot", np.array([0.5]), biped),)
    )
    own, other = (foot_geoms(biped.model, foot_bodies(biped, foot)) for foot in (0, 1))
    for geom in own:
        before, after = pair_settings(biped.model, geom), pair_settings(changed, geom)
        assert after[0][0] == pytest.approx(0.5 * before[0][0])
        assert after[0][1:].tolist() == before[0][1:].tolist()
        assert after[1].tolist() == before[1].tolist()
        assert after[2] == before[2]
    for geom in other:
        assert (
            pair_settings(changed, geom)[0].tolist() == pair_settings(biped.model, geom)[0].tolist()
        )
    assert len(floor_geoms(biped.model)) == 1
    same = edited(
        biped.model,
        (effect("ground_compliance").alteration("left_foot", np.array([1.0, 1.0]), biped),),
    )
    np.testing.assert_array_equal(same.geom_priority, biped.model.geom_priority)


def test_compliance_divides_the_spring_and_keeps_the_damping_ratio(biped):
    bodies = foot_bodies(biped, 0)
    soft = edited(biped.model, (ChangedGround(bodies, compliance=4.0, damping=0.5),))
    geom = foot_geoms(biped.model, bodies)[0]
    (time, ratio), (slow, less) = pair_settings(biped.model, geom)[1], pair_settings(soft, geom)[1]
    # k' goes with 1 / (T r)^2 and b' with 1 / T
    assert (slow * less) ** 2 / (time * ratio) ** 2 == pytest.approx(4.0)
    assert less == pytest.approx(0.5 * ratio)
    assert time / slow == pytest.approx(0.5 / np.sqrt(4.0))


def test_pads_push_and_never_pull(biped):
    _, law = nominal_ground(biped, ("left_foot", "left_toe_plate"))
    depth = np.array([[-1e-3, -1e-3], [1e-3, -1e-3], [1e-3, 1e-3]])
    still, lifting = law.force(depth, np.zeros((3, 2))), law.force(depth, np.full((3, 2), -10.0))
    assert still[0] == 0
    assert 0 < still[1] < still[2]
    assert not lifting.any()


@pytest.mark.parametrize("friction", [0.5, 1.0])
@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
def test_static_force_of_a_pad_is_mujocos(tmp_path, friction, cone):
    """A ball at rest on a plane sinks until the contact bears its weight."""
    import mujoco

    path = tmp_path / "ball.xml"
    path.write_text(
        f'<mujoco><option cone="{cone}"/><default><geom friction="{friction}"/></default>'
        '<worldbody><geom name="floor" type="plane" size="1 1 1"/><body name="hull" pos="0 0 '
        '0.5"><freejoint/>'
        '<inertial pos="0 0 0" mass="3" diaginertia="0.01 0.01 0.01"/><body name="sole"><joint '
        'name="j" axis="0 0 1" type="slide"/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/><geom type="sphere" '
        'size="0.1" mass="0"/></body></body></worldbody>'
        '<actuator><position joint="j" kp="5000" kv="50"/></actuator></mujoco>'
    )
    subject = load_subject(path)
    model = subject.model
    data = mujoco.MjData(model)
    data.qpos[2] = 0.1
    model.dof_damping[-1] = 50.0
    for _ in range(4000):
        data.qfrc_applied[-1] = -5000 * data.qpos[-1]
        mujoco.mj_step(model, data)
    depth = 0.1 - float(data.body("sole").xpos[2])
    _, law = nominal_ground(subject, ("sole",))
    assert law.force(np.array([[depth]]), np.zeros((1, 1)))[0] == pytest.approx(4 * 9.81, rel=0.02)


def test_without_forces_there_is_no_balance(standing):
    signals = dataclasses.replace(standing(), contact=None)
    assert footings(signals) == ()
    assert ground_residual(signals) is None
    assert effect("ground_friction").trace(signals, "left_foot", np.array([[0.5]])) == {}
