import numpy as np
import pytest
import robots

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.playback.replay import replay
from hyperleg_design.gap.playback.windows import short_windows
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject


def conditioned(log):
    return condition(log, load_subject(None, [log]))


def residual(signals, residual_name="motion"):
    return signals.residual[residual_name][signals.valid]


@pytest.mark.parametrize("state", ["standing", "thrown"])
def test_balances_of_a_floating_robot_vanish(biped_runs, state):
    signals = conditioned(biped_runs[state])
    assert np.isfinite(residual(signals)).all()
    assert np.abs(residual(signals)).max() < 0.3  # of 15 Nm, at the knees
    assert np.sqrt(np.mean(residual(signals, "base")[:, :3] ** 2)) < 0.5  # of 318 N of weight
    assert np.sqrt(np.mean(residual(signals, "base")[:, 3:] ** 2)) < 0.1


def judged(signals, residual_name="motion"):
    """Rows that are known at all valid ticks."""
    rows = residual(signals, residual_name)
    return [place for place in range(rows.shape[1]) if np.isfinite(rows[:, place]).all()]


def test_without_forces_the_rows_that_none_of_them_reaches_balance(biped_runs):
    """Standing on both feet: what these do against each other is told by some joints, and inside
    of the feet nothing is known.
    """
    standing = conditioned(robots.without(biped_runs["standing"], "contact_force"))
    assert np.isnan(residual(standing, "base")).all()
    assert len(judged(standing)) == 7  # of 14, without 2 in the feet and 5 that are spent
    # rows that are combined hold what is left over in several
    assert np.abs(residual(standing)[:, judged(standing)]).max() < 0.5
    thrown = conditioned(robots.without(biped_runs["thrown"], "contact_force"))
    assert not thrown.touching.any()
    assert np.abs(residual(thrown)).max() < 0.3


def test_the_wrench_on_a_foot_that_stands_alone_is_what_the_base_needs(biped_runs):
    """Right leg drawn up: forward kinematics alone says that only the left may touch."""
    log = robots.without(biped_runs["standing"], "contact_force")
    lifted = log.changed(
        signals={
            c: v + {"position/right_knee": 0.8, "position/right_hip_pitch": -0.4}.get(c, 0.0)
            for c, v in log.signals.items()
        }
    )
    signals = conditioned(lifted)
    joints = signals.subject.joints
    unknown = [i for i, j in enumerate(joints) if j.startswith("left_toe")]
    assert judged(signals) == [i for i in range(len(joints)) if i not in unknown]


def test_a_foot_without_forces_in_a_log_that_has_some_carries_nothing_in_the_air(biped_runs):
    """As shapes on a quadruped's hips do, which are no feet but look like some."""
    log = biped_runs["standing"]
    told = {c: v for c, v in log.signals.items() if not c.startswith("contact_force/right")}
    standing = conditioned(log.changed(signals=told))
    joints = standing.subject.joints
    unknown = [i for i, j in enumerate(joints) if j.startswith("right_toe")]
    assert judged(standing) == [i for i in range(len(joints)) if i not in unknown]
    assert np.abs(residual(standing)[:, judged(standing)]).max() < 0.5
    assert np.isnan(residual(standing, "base")).all()
    lifted = {
        c: v + {"position/right_knee": 0.8, "position/right_hip_pitch": -0.4}.get(c, 0.0)
        for c, v in told.items()
    }
    raised = conditioned(log.changed(signals=lifted))
    assert np.isfinite(residual(raised)).all()
    assert np.isfinite(residual(raised, "base")).all()


def test_total_of_a_foot_with_several_pads_has_no_known_place(biped_runs):
    log = biped_runs["standing"]
    signals = {c: v for c, v in log.signals.items() if not c.startswith("contact_force/")}
    for side in ("left", "right"):
        for axis in "xyz":
            pads = [
                v
                for c, v in log.signals.items()
                if c.startswith(f"contact_force/{side}") and c.endswith(f"_{axis}")
            ]
            signals[f"contact_force/{side}_foot_{axis}"] = np.sum(pads, 0)
    found = conditioned(log.changed(signals=signals))
    np.testing.assert_allclose(found.contact, conditioned(log).contact, atol=1e-9)
    assert judged(found, "base") == [0, 1, 2]
    assert np.sqrt(np.mean(residual(found, "base")[:, :3] ** 2)) < 0.5
    assert len(judged(found)) >= 8
    assert np.abs(residual(found)[:, judged(found)]).max() < 0.5


def test_force_on_a_foot_of_another_robot(biped_runs):
    log = biped_runs["standing"]
    wrong = log.changed(signals={**log.signals, "contact_force/tail_x": log.time})
    with pytest.raises(InputError, match="tail"):
        conditioned(wrong)


def test_replays_of_stance_and_flight(biped_runs):
    for state in ("standing", "thrown"):
        signals = conditioned(biped_runs[state])
        found = replay(signals, windows=short_windows(signals, 0.2))
        position, _ = found.errors(signals)
        assert np.nanmax(np.abs(position)) < 3e-3
        place = signals.base.position[found.windows.ticks]
        assert np.nanmax(np.abs(found.base[0, ..., :3] - place)) < 3e-3


BOXED = """<mujoco><worldbody><body name="trunk" pos="0 0 0.5"><freejoint/>
<geom size="0.1" mass="4" contype="0" conaffinity="0"/>
<body name="foot" pos="0 0 -0.4"><joint name="ankle" axis="0 1 0"/>
<geom name="sole" type="box" size="0.1 0.05 0.02" mass="0.5"/></body></body></worldbody>
<actuator><motor joint="ankle"/></actuator></mujoco>"""


def test_the_force_on_a_foot_of_one_shape_may_bear_its_name(tmp_path):
    """A box has a pad at each corner; no pad has the name of the box."""
    path = tmp_path / "robot.xml"
    path.write_text(BOXED)
    time = np.arange(0, 1, 0.005)
    still = {
        f"contact_force/{{}}_{axis}": np.full_like(time, f)
        for axis, f in zip("xyz", (1, 2, 44), strict=True)
    }
    rest = {
        "position/ankle": 0.1 * np.sin(6 * time),
        "motor_torque/ankle": 0.0 * time,
        **{f"base_orientation/{axis}": np.full_like(time, axis == "w") for axis in "wxyz"},
        **{f"accelerometer/{axis}": np.full_like(time, 9.81 * (axis == "z")) for axis in "xyz"},
        **{f"gyro/{axis}": 0.0 * time for axis in "xyz"},
    }
    by_foot, by_shape = (
        Log(
            "stands",
            time,
            rest | {c.format(name): v for c, v in still.items()},
            Metadata(base="floating"),
        )
        for name in ("foot", "sole")
    )
    subject = load_subject(str(path), [by_foot])
    found = [condition(log, subject) for log in (by_foot, by_shape)]
    assert np.array_equal(found[0].contact, found[1].contact)
    assert np.isfinite(found[1].contact).all()
    assert np.array_equal(found[0].residual["base"], found[1].residual["base"], equal_nan=True)


def test_rows_that_need_a_torque_that_nobody_measured_are_unknown(biped_runs):
    """Without forces under two feet, rows of several joints are combined."""
    log = robots.without(biped_runs["standing"], "contact_force")
    known = conditioned(log)
    knee = known.subject.joints.index("left_knee")
    dropped = {"joint_torque/left_knee", "position_target/left_knee"}
    less = conditioned(
        log.changed(signals={c: v for c, v in log.signals.items() if c not in dropped})
    )
    without = less.elimination
    needs = np.abs(without.of_joints[:, :, knee]) > 1e-2
    rows = less.residual["motion"][without.ticks]
    assert np.isnan(rows[needs]).all()
    assert len(judged(less)) < len(judged(known))
