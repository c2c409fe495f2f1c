import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.judge import Judge
from hyperleg_design.gap.inference.screen import linearise, places
from hyperleg_design.gap.inference.sensitivity import OFTEN, PAID, RARELY, smallest
from hyperleg_design.gap.inference.thresholds import load_thresholds
from hyperleg_design.gap.pipeline.diagnose import diagnose

KNEE = ("viscous_friction", "knee")


@pytest.fixture(scope="module")
def healthy(robot_files):
    """Judge of two logs of a healthy coupled rig."""
    ready = diagnosed.prepared(
        robot_files["coupled"], diagnosed.run("healthy", 0), diagnosed.run("healthy", 1)
    )
    return Judge(ready.base, load_thresholds(), 1)


def change_of(judge, name):
    return next(one.change for one in smallest(judge, [name]))


def rubbing(damping, seed):
    """Log of the rig with more viscous friction at its knee."""
    kept = dict(diagnosed.CHANGES)
    try:
        diagnosed.CHANGES["viscous"] = [
            (
                'name="knee" axis="0 1 0" damping="0.03"',
                f'name="knee" axis="0 1 0" damping="{0.03 + damping}"',
            )
        ]
        return diagnosed.run("viscous", seed)
    finally:
        diagnosed.CHANGES.update(kept)


def test_it_is_what_projecting_the_errors_out_of_the_trace_leaves(healthy):
    """By one large regression of all samples, sessions apart, in place of sums of products."""
    base = healthy.base
    samples, cause = (
        base.samples,
        linearise(base.samples, EFFECTS[KNEE[0]], KNEE[1], EFFECTS[KNEE[0]].nulls),
    )
    told = 0.0
    for session in range(samples.sessions):
        here = samples.session[samples.part] == session
        trace, errors = (cause.columns[0] * samples.weight)[here], base.errors[:, here]
        normal = np.linalg.solve(errors @ errors.T + base.prior.precision, errors @ trace)
        told += trace @ trace - trace @ errors.T @ normal
    rules = healthy.thresholds
    least = (np.sqrt(2 * (rules.evident + PAID)) + OFTEN) / np.sqrt(told)
    visible = rules.visible / np.sqrt(healthy.in_rows(cause.columns[0]).max())
    assert change_of(healthy, KNEE) == pytest.approx(max(least, visible) * cause.usual[0], rel=1e-6)


@pytest.mark.parametrize(("times", "verdict"), [(2.0, "explained"), (0.25, "none")])
def test_what_is_larger_is_named_and_what_is_much_smaller_is_not(
    healthy, robot_files, times, verdict
):
    damping = times * change_of(healthy, KNEE)
    found = diagnose(robot_files["coupled"], [rubbing(damping, 0), rubbing(damping, 1)])
    assert found.verdict == verdict
    assert [(c.effect, c.location) for c in found.causes] == (
        [KNEE] if verdict == "explained" else []
    )


def test_more_logs_show_less(healthy, robot_files):
    ready = diagnosed.prepared(
        robot_files["coupled"], *(diagnosed.run("healthy", seed) for seed in range(4))
    )
    assert change_of(Judge(ready.base, load_thresholds(), 1), KNEE) < change_of(healthy, KNEE)


def test_each_size_is_possible_and_none_is_of_what_acts_in_rare_moments(healthy):
    subject = healthy.base.samples.filtered_logs[0].signals.subject
    found = smallest(healthy, places(subject))
    assert {one.effect for one in found} >= {
        "coulomb_friction",
        "payload",
        "encoder_offset",
        "backlash",
        "torque_constant",
    }
    assert not {one.effect for one in found} & {*RARELY}
    for one in found:
        effect = EFFECTS[one.effect]
        place = [p.name for p in effect.parameters].index(one.parameter)
        low, high = effect.bounds(one.location, subject)[:, place]
        null = effect.parameters[place].null
        assert 0 < one.change <= max(high - null, null - low)
        assert not effect.parameters[place].shape


def test_threads_change_nothing(healthy):
    subject = healthy.base.samples.filtered_logs[0].signals.subject
    wanted = places(subject, ["coulomb_friction", "payload", "backlash"])
    assert smallest(healthy, wanted) == smallest(Judge(healthy.base, healthy.thresholds, 2), wanted)


def test_a_diagnosis_tells_it(robot_files):
    told = diagnose(robot_files["coupled"], [diagnosed.run("healthy", 0)]).mapping()["sensitivity"]
    assert {(one["effect"], one["location"]) for one in told} >= {KNEE}
